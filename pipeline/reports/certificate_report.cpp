#include "pipeline/reports/certificate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace {

/// From the records of the stages.
CertificateRun run_of(const CasePaths& paths, const StageRecord& mesh, std::size_t n_tets,
                      const Parameters& parameters) {
  CertificateRun run;
  const auto add = [&](const StageRecord& record) {
    run.seconds.emplace_back(section_of(record.stage), record.run.seconds);
    run.peak_memory_MB = std::max(run.peak_memory_MB, record.run.peak_memory_MB);
  };
  if (!has_own_psi(parameters.mesh())) {
    for (const Stage stage : {Stage::Cloud, Stage::LevelSet}) {
      const StageState state = inspect_stage(paths, stage, parameters.section(section_of(stage)), std::nullopt);
      if (!state.record) continue;
      add(*state.record);
      const double t = state.record->run.seconds;
      if (stage == Stage::LevelSet && t > 0) {
        run.points_per_s = static_cast<double>(level_set_report(*state.record).fit.n_points) / t;
      }
    }
  }
  add(mesh);
  if (const double t = mesh.run.seconds; t > 0) run.tets_per_s = static_cast<double>(n_tets) / t;
  run.threads = mesh.run.threads;
  run.host = mesh.run.host;
  run.date = mesh.run.date;
  return run;
}

// Of h: sizes go down to edges of which the noise is .3 (kMostNoise), or halfway there.
constexpr double kNoisy = .15;

/// What to try next when a mesh has failed.
std::string remedy_for(const Certificate& c) {
  const double h = c.measured.mesh.h;
  const std::optional<double>& gate = c.verdict.min_quality_gate;
  if (c.verdict.reasons.size() == 1 && gate && c.measured.mesh.quality.min < *gate) {
    return fmt::format("another --h (this was {:.4g}), which moves the worst tets, or a lower --min-quality", h);
  }
  if (const auto& cloud = c.measured.cloud; c.measured.sizes && cloud && cloud->noise.value_or(0) > kNoisy * h) {
    return fmt::format(
        "a larger --h-min (the smallest edges are {:.4g}, and the noise of the samples is {:.2g} of that), which shows "
        "less of the noise",
        h, *cloud->noise / h);
  }
  const std::optional<std::vector<ThinPlace>>& thin = c.measured.resolution.too_thin;
  const std::string enough =
      thin && !thin->empty() ? fmt::format(": {:.3g} shows what is thinnest", thin->front().h_needed) : "";
  return fmt::format("a smaller --h (this was {:.4g}), which resolves more of the shape", h) + enough +
         (c.measured.n_points ? "; where psi itself is wrong there, a finer --spacing" : "");
}

/// The places of a kind in words.
std::string said_of(const PlaceReport::OfKind& k, const ZeroSetReport& domain, bool strict) {
  const MeshPlace& worst = k.worst;
  const std::size_t n = strict ? k.n : k.n - k.n_small;
  const std::string places = n == 1 ? "1 place" : fmt::format("{} places", n);
  const std::string at = fmt::format("({:.6g}, {:.6g}, {:.6g})", worst.where.x(), worst.where.y(), worst.where.z());
  const double off = worst.off_over_h;
  switch (k.kind) {
    case PlaceKind::Folded:
      return fmt::format("the boundary is folded over at {}, the worst, of {} faces at {}, {:.2g} h off psi = 0",
                         places, worst.n, at, off);
    case PlaceKind::Off:
      return fmt::format("the boundary is off psi = 0 at {}, the worst at {} by {:.2g} h", places, at, off);
    case PlaceKind::Filled:
      return fmt::format("a gap is filled, for the boundary to be a manifold, at {}, the worst at {}, {:.2g} h deep",
                         places, at, off);
    case PlaceKind::Cut:
      return fmt::format("body is cut away, for the boundary to be a manifold, at {}, the worst at {}, {:.2g} h deep",
                         places, at, off);
    case PlaceKind::Thin:
      return fmt::format("the mesh lacks what is thin at {}: psi = 0 is {:.2g} h from its boundary at {}", places, off,
                         at);
    case PlaceKind::Topology:
      return fmt::format(
          "psi = 0 has {} pieces (and {} dropped ones) of Euler characteristic {} on a grid of spacing {:.3g}, the "
          "boundary of the mesh {} of {}: h is too large for this shape, most of all at {}",
          domain.components_kept, domain.components_dropped.size(), domain.euler_characteristic_of_kept_components,
          domain.counting_spacing, domain.components_meshed, domain.euler_characteristic_meshed, at);
    case PlaceKind::Missed:
      return fmt::format(
          "samples of the surface are farther than h from the mesh at {}, the worst, {} samples at {}, {:.2g} h: h is "
          "too large for what is there",
          places, worst.n, at, off);
  }
  return "";
}

}  // namespace

std::vector<std::string> failures(const SecondOrderReport& report) {
  return failures(report.certificate, report.repairs ? report.repairs->n_mid_sides_put_back : 0);
}

Verdict judge_shape(const MeshMeasures& measured, bool strict, const std::string& accept) {
  Verdict verdict;
  verdict.reasons = measured.reasons;
  verdict.strict = strict;
  verdict.accept = accept;
  const std::vector<AcceptedPlaces> accepted = parse_accepted_places(accept);
  for (const PlaceReport::OfKind& k : measured.places.kinds) {
    if (k.n == k.n_small && !strict) continue;
    const bool is_accepted = std::any_of(accepted.begin(), accepted.end(), [&](const AcceptedPlaces& a) {
      return a.kind == k.kind && (!a.most_off_over_h || k.max_off_over_h <= *a.most_off_over_h);
    });
    (is_accepted ? verdict.accepted : verdict.reasons).push_back(said_of(k, measured.domain, strict));
  }
  return verdict;
}

Verdict judge(const MeshMeasures& measured, const Parameters& parameters) {
  Verdict verdict = judge_shape(measured, parameters.output().strict, parameters.output().accept);
  const double gate = parameters.output().min_quality;
  if (!(gate > 0)) return verdict;
  verdict.min_quality_gate = gate;
  const double least = measured.mesh.quality.min;
  if (least < gate) {
    verdict.reasons.push_back(fmt::format("min quality {:.4f} is below the gate of {:.4f}", least, gate));
  }
  return verdict;
}

Certificate verdict_on(MeshMeasures measured, const Parameters& parameters) {
  Certificate c;
  c.units = units_of(parameters);
  if (const std::int64_t asked = parameters.mesh().tets; asked > 0) c.n_tets_asked = asked;
  c.verdict = judge(measured, parameters);
  c.measured = std::move(measured);
  if (!c.verdict.passes()) c.remedy = remedy_for(c);
  return c;
}

std::optional<std::string> units_of(const Parameters& parameters) {
  const std::string& units = parameters.output().units;
  if (units.empty()) return std::nullopt;
  return units;
}

Certificate certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters) {
  Certificate c = verdict_on(mesh_report(mesh).measured, parameters);
  c.run = run_of(paths, mesh, c.measured.mesh.n_tets, parameters);
  c.run->checksum = seal_of(to_json(c));
  return c;
}

}  // namespace umtet
