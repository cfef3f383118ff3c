#include "pipeline/reports/blame.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "body/fidelity/input_judgement.h"

namespace umtet {
namespace {

// A fit tolerates a few wrong normals; a patch with this share of them is a separate wall in psi.
constexpr double kManyWrong = .05;
// Share of neighbouring pairs whose normals agree if 15 % of the normals are turned at random: 1 - 2 (.15) (.85), as
// consistency() explains.
constexpr double kLeastConsistent = .745;
// In units of h: sizes decrease until the noise is .3 of an edge (kMostNoise), or halfway there.
constexpr double kNoisy = .15;
// In units of h: from this value on, the mesh shows the noise of the samples.
constexpr double kNoiseShows = .3;

bool fails_by(const std::vector<InputDefect>& defects, InputDefectKind kind) {
  return std::any_of(defects.begin(), defects.end(),
                     [&](const InputDefect& d) { return d.kind == kind && !d.is_small; });
}

std::optional<Blame> blame_of_guesses(const MeshMeasures& m, const std::vector<InputDefect>& defects) {
  const bool is_guess = fails_by(defects, InputDefectKind::Guessed);
  if (is_guess || fails_by(defects, InputDefectKind::Handles) || fails_by(defects, InputDefectKind::Pieces)) {
    const double guessed = m.domain.support ? m.domain.support->unsupported_area_fraction : 1;
    return Blame{"input", fmt::format("no sample is near {:.0f} % of the boundary", 100 * guessed),
                 "a scan of the missing part; --close flat or smooth closes it in another way, and --accept "
                 "guessed,handles,pieces accepts the guess"};
  }
  return std::nullopt;
}

std::optional<Blame> blame_of_normals(const MeshMeasures& m) {
  if (!m.input) return std::nullopt;
  const InputFacts& facts = *m.input;
  const std::string remedy = facts.normals_given
                                 ? "normals that all look outward, or --normals estimate"
                                 : "a cloud with normals, or --orient-from FILE with the positions of the scanner";
  if (facts.turned > kManyWrong) {
    return Blame{"normals",
                 fmt::format("{:.2g} % of the normals were turned, by {}", 100 * facts.turned, facts.turned_by),
                 remedy};
  }
  if (facts.doubtful > kManyWrong) {
    return Blame{"normals", fmt::format("the outward side of {:.0f} % of the samples is a guess", 100 * facts.doubtful),
                 remedy};
  }
  if (facts.opposed > kManyWrong) {
    return Blame{"normals", fmt::format("{:.2g} % of the normals point against grad psi", 100 * facts.opposed), remedy};
  }
  return std::nullopt;
}

/// Given normals that contradict their neighbours bound no body, wherever there are samples.
std::optional<Blame> blame_of_contradictions(const MeshMeasures& m) {
  if (!m.input || !(m.input->consistency < kLeastConsistent)) return std::nullopt;
  return Blame{
      "normals", fmt::format("{:.0f} % of the normals agree with their neighbours", 100 * m.input->consistency),
      m.input->normals_given ? "--normals estimate, or more samples where two sides of the body are close"
                             : "a cloud with normals, or --orient-from FILE with the positions of the scanner"};
}

std::optional<Blame> blame_of_noise(const MeshMeasures& m) {
  if (!m.cloud) return std::nullopt;
  const double h = m.mesh.h, noise = m.cloud->noise.value_or(0);
  if (m.sizes && noise > kNoisy * h) {
    return Blame{"input", fmt::format("the noise of the samples is {:.2g} of the smallest edges, {:.4g}", noise / h, h),
                 fmt::format("--h-min {:.3g}, which shows less of the noise", noise / kNoisy)};
  }
  if (!m.sizes && noise > 1.01 * kNoiseShows * h) {
    return Blame{"input", fmt::format("the noise of the samples is {:.2g} h", noise / h),
                 fmt::format("--h {:.3g}, which shows less of the noise", noise / kNoiseShows)};
  }
  return std::nullopt;
}

std::optional<Blame> blame_of_labels(const MeshMeasures& m, const std::vector<InputDefect>& defects) {
  if (!m.labels || !m.labels->kernel) return std::nullopt;
  const LabelVolumeReport& r = *m.labels;
  if (std::all_of(defects.begin(), defects.end(), [](const InputDefect& d) { return d.is_small; })) return std::nullopt;
  return Blame{"labels",
               fmt::format("smoothing of the mask by {:.2g} voxels changes its volume by {:+.2g} %", *r.kernel,
                           100 * (r.volume_of_psi / r.volume_of_voxels - 1)),
               fmt::format("--part-smooth {:.2g}, or no --part-smooth, which keeps the volume", *r.kernel / 2)};
}

/// Returns the h that resolves all defects that are not small, where psi = 0 explains them.
std::optional<double> h_that_shows(const MeshMeasures& m) {
  std::optional<double> least;
  for (const MeshDefect& defect : m.defects.listed) {
    if (is_small(defect) || !defect.h_needed) continue;
    least = std::min(least.value_or(*defect.h_needed), *defect.h_needed);
  }
  if (!least && m.resolution.too_thin && !m.resolution.too_thin->empty()) {
    least = m.resolution.too_thin->front().h_needed;
  }
  return least;
}

Blame blame_of_mesh(const MeshMeasures& m) {
  const double h = m.mesh.h;
  const std::optional<double> shows = h_that_shows(m);
  if (shows && *shows < h && m.search && m.search->at_max_tets) {
    return {"max_tets", fmt::format("--max-tets limits h to {:.4g}, and the thinnest part needs {:.3g}", h, *shows),
            "a larger --max-tets"};
  }
  if (shows && *shows < h) {
    return {"h", fmt::format("h is {:.4g}, and the thinnest part needs {:.3g}", h, *shows),
            fmt::format("--h {:.3g}{}", *shows, m.n_points ? ", or --background graded" : "")};
  }
  if (!m.is_valid || !coarseness(m.mesh).empty() || !m.reasons.empty()) {
    return {"h", fmt::format("h is {:.4g}", h), "a smaller --h"};
  }
  return {"mesh", fmt::format("{} defects at h = {:.4g}", m.defects.n(), h),
          fmt::format("another --h, such as {:.4g}, or a larger --effort", .97 * h)};
}

Blame blame_of_psi(const MeshMeasures& m) {
  const std::optional<double>& spacing = m.domain.level_set_spacing;
  if (!spacing) return {"h", fmt::format("h is {:.4g}, and the mesh fits psi", m.mesh.h), "a smaller --h"};
  return {"level set", fmt::format("the finest lattice of psi has a spacing of {:.3g}", *spacing),
          fmt::format("--spacing {:.3g}, which rounds edges less", .5 * *spacing)};
}

}  // namespace

Blame blame_for_failure(Stage at_work, const std::string& message, const std::optional<InputFacts>& facts) {
  if (at_work != Stage::Cloud) {
    MeshMeasures m;
    m.input = facts;
    if (auto blame = blame_of_contradictions(m)) return *blame;
    if (auto blame = blame_of_normals(m)) return *blame;
  }
  const char* stage = at_work == Stage::Cloud ? "input" : at_work == Stage::LevelSet ? "level set" : "mesh";
  return {stage, message.substr(0, message.find('\n')), ""};
}

Blame blame_for(const Certificate& c) {
  const MeshMeasures& m = c.measured;
  const std::optional<double>& gate = c.verdict.min_quality_gate;
  if (c.verdict.reasons.size() == 1 && gate && m.mesh.quality.min < *gate) {
    return {
        "mesh", fmt::format("the minimum Q is {:.4f}", m.mesh.quality.min),
        fmt::format("another --h (this was {:.4g}), which moves the worst tets, or a lower --min-quality", m.mesh.h)};
  }
  if (auto blame = blame_of_contradictions(m)) return *blame;
  if (auto blame = blame_of_guesses(m, input_defects(m))) return *blame;
  if (auto blame = blame_of_normals(m)) return *blame;
  if (auto blame = blame_of_noise(m)) return *blame;
  if (auto blame = blame_of_labels(m, input_defects(m))) return *blame;
  if (!c.verdict.is_valid || !c.verdict.fits_psi || c.verdict.fits_input) return blame_of_mesh(m);
  return blame_of_psi(m);
}

}  // namespace umtet
