#include "reconstruct/solve/fit_ssd.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/first_touch.h"
#include "common/formatted.h"
#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/solve/closing.h"
#include "reconstruct/solve/fit_measures.h"
#include "reconstruct/solve/multigrid.h"
#include "reconstruct/solve/outer_wall.h"
#include "reconstruct/solve/resolution.h"
#include "reconstruct/solve/ssd_assembled.h"
#include "reconstruct/solve/ssd_band.h"

namespace umtet {

std::vector<std::string> problems(const SsdParams& params) {
  std::vector<std::string> p = problems(params.prior);
  if (!(params.spacing >= 0 && std::isfinite(params.spacing))) p.emplace_back("spacing must be >= 0 (0: automatic)");
  if (!(params.smoothing >= 0 && std::isfinite(params.smoothing)))
    p.emplace_back("smoothing must be >= 0 (0: automatic)");
  if (!(params.noise >= 0 && std::isfinite(params.noise))) p.emplace_back("noise must be >= 0");
  if (!(params.detail > 0 && std::isfinite(params.detail))) p.emplace_back("detail must be > 0");
  if (!(params.finest >= 0 && std::isfinite(params.finest))) p.emplace_back("finest must be >= 0");
  if (!(params.smooth > 0 && std::isfinite(params.smooth))) p.emplace_back("smooth must be > 0");
  if (!(params.alpha > 0)) p.emplace_back("alpha must be > 0");
  if (!(params.tolerance > 0 && params.tolerance < 1)) p.emplace_back("tolerance must be in (0, 1)");
  if (params.max_iterations < 1) p.emplace_back("max_iterations must be >= 1");
  if (!(params.band_tolerance > 0 && params.band_tolerance < 1)) p.emplace_back("band_tolerance must be in (0, 1)");
  if (params.coarsest_nodes < 1) p.emplace_back("coarsest_nodes must be >= 1");
  if (params.padding < 1) p.emplace_back("padding must be >= 1");
  if (params.solver == SsdSolver::Multilevel) {
    if (params.weights == SsdWeights::Paper) p.emplace_back("weights = paper needs solver = full or assembled");
    if (params.prior.kind == LmePrior::Kind::Gaussian)
      p.emplace_back("prior = gaussian needs solver = full or assembled");
  }
  return p;
}

namespace {

constexpr std::ptrdiff_t kDenseNodes = 3000;       // more are never factored densely on the coarsest lattice
constexpr double kMostNodes = 1e9;                 // a full lattice holds no more: about 200 bytes each
constexpr std::ptrdiff_t kAssembledNodes = 16000;  // more are never factored at all: that takes a minute

// Seconds of one core, about: a solve per node of the finest lattice; a dense Cholesky factor per node cubed. Only
// their ratio counts.
constexpr double kSolveSeconds = 4.5e-6, kFactorSeconds = 4e-11;

// Halvings enough for the longest axis of a lattice.
constexpr int kMostLevels = 24;

struct Hierarchy {
  Lattice finest;
  int n_levels = 1;
};

// The lattice around the box whose cells can be halved until a dense factor is cheap. Each halving rounds the numbers
// of cells up to a higher power of two: the cheapest sum of both wins.
Hierarchy choose_hierarchy(const Eigen::AlignedBox3d& box, double h, int padding, int width) {
  const Vec3 wanted = box.sizes() / h + Vec3::Constant(2 * padding);
  if (!(wanted.prod() < kMostNodes && wanted.maxCoeff() < kMostNodes)) {
    throw std::length_error(
        formatted("spacing %.6g asks for %.3g lattice nodes: choose a larger one", h, wanted.prod()));
  }
  Hierarchy best;
  double least = std::numeric_limits<double>::infinity();
  for (int levels = 1; levels <= kMostLevels; ++levels) {
    const int step = 1 << (levels - 1);
    Eigen::Vector3i cells;
    for (int d = 0; d < 3; ++d) {
      cells[d] = std::max((static_cast<int>(std::ceil(wanted[d])) + step - 1) / step, width - 1) * step;
    }
    if (!(cells.cast<double>().prod() < kMostNodes)) break;  // rounding up to 2^levels makes flat lattices thick
    const Eigen::Vector3d coarse = (cells / step + Eigen::Vector3i::Ones()).cast<double>();
    if (coarse.prod() > kDenseNodes) continue;
    const Lattice lattice{box.center() - h / 2 * cells.cast<double>(), h, cells + Eigen::Vector3i::Ones()};
    const double seconds =
        kSolveSeconds * static_cast<double>(lattice.size()) + kFactorSeconds * std::pow(coarse.prod(), 3);
    if (seconds < least) {
      least = seconds;
      best = {lattice, levels};
    }
  }
  if (best.finest.size() == 0) {
    throw std::length_error(
        formatted("spacing %.6g asks for a lattice of %.0f x %.0f x %.0f cells, too many or too "
                  "unlike for multigrid: choose a larger spacing",
                  h, wanted[0], wanted[1], wanted[2]));
  }
  return best;
}

// Samples with this much more noise than the cloud's are told from the others.
constexpr double kUnusual = 2;
// A cell is resolved where samples have no gap of more than two spacings, root of kMostArea. Noise counts as a gap: 6
// times it is a spacing of three times the noise, as where noise is the same everywhere; of two sheets, of which each
// sample sees more of its own, half as much again.
constexpr double kGapOfNoise = 9;

// What both ways of fitting start from.
struct Problem {
  const OrientedPointCloud& cloud;
  const SsdParams& params;
  const Context& context;
  LmeTables tables;
  Eigen::AlignedBox3d box;
  std::vector<double> area;  // a_i; empty for the paper's weights
  std::vector<int> n_share;  // how many samples share the area around each
  double finest_smoothing;   // c in the finest band
};

SsdSample sample_of(const Problem& problem, const Lattice& lattice, std::size_t i) {
  const std::vector<double>& area = problem.area;
  const SsdParams& params = problem.params;
  const double h = lattice.h, l = finest_value_length(h, params.noise);
  SsdSample s;
  s.xi = (problem.cloud.points[i] - lattice.origin) / h;
  s.normal = problem.cloud.normals[i];
  // With f = h F and x = h xi, both functionals divided by h² (area) or as they stand (paper):
  s.w_value = area.empty() ? h * h : area[i] / (l * l);
  s.w_gradient = area.empty() ? 1.0 : area[i] / (h * h);
  s.gap2 = problem.n_share[i] * s.w_gradient;
  if (area.empty() || params.local_noise.empty()) return s;
  if (const double noise = params.local_noise[i]; noise > kUnusual * params.noise) {
    s.w_value = area[i] / std::pow(finest_value_length(h, noise), 2);
    s.gap2 = std::max(s.gap2, std::pow(kGapOfNoise * noise / h, 2));
  }
  return s;
}

// Where each step begins, as a share of the time.
constexpr double kSetup = .2, kSolve = .3, kRefine = .5;

// The level set on all nodes of one lattice.
// @param samples  in the units of that lattice
LevelSet fit_lattice(const Problem& problem, const Hierarchy& hierarchy, std::vector<SsdSample> samples,
                     double tolerance, SsdReport& report) {
  const SsdParams& params = problem.params;
  const Lattice& lattice = hierarchy.finest;
  const bool by_area = params.weights == SsdWeights::Area;
  const double kappa = by_area ? report.smoothing : params.alpha * lattice.h;
  const SsdOperator op(problem.tables, lattice.n, kappa, std::move(samples));
  report.n_nodes = lattice.size();
  std::vector<double> c;  // in units of the spacing
  if (params.solver == SsdSolver::Assembled) {
    if (op.size() > kAssembledNodes) {
      throw SolveError(
          formatted("the assembled solver is for up to %zu nodes, this lattice has %zu: use another solver or a larger "
                    "spacing",
                    kAssembledNodes, op.size()));
    }
    c = solve_assembled(op);
  } else {
    Multigrid multigrid(op, hierarchy.n_levels);
    std::vector<double> r(op.size() + SsdOperator::kPad, 0.0);
    op.right_hand_side(r.data());
    problem.context.report("solve", kSolve);
    const PcgReport pcg = solve_pcg(op, multigrid, r, tolerance, params.max_iterations, c, [&](double residual) {
      const double done = std::clamp(std::log(residual) / std::log(tolerance), 0.0, 1.0);
      problem.context.report("solve", kSolve + (kRefine - kSolve) * done);
    });
    report.iterations = pcg.iterations;
    report.residuals = pcg.residuals;
    if (!pcg.converged) {
      throw SolveError(formatted("%zu nodes, smoothing %.3g: relative residual %.2e after %d iterations, wanted %.1e",
                                 op.size(), op.kappa(), pcg.residuals.back(), pcg.iterations, tolerance));
    }
  }
  c.resize(op.size() + SsdOperator::kPad, 0.0);
  if (params.solver != SsdSolver::Multilevel) {
    std::vector<double> workspace;
    // Back to model units: E = h² times the lattice functional for area weights; eq. (10) is written in its own units.
    report.energy_hessian = (by_area ? lattice.h * lattice.h : 1) * op.energies(c.data(), workspace)[2];
  }
  c.resize(op.size());
  for (double& v : c) v *= lattice.h;
  return LevelSet(params.prior, {lattice, std::move(c)});
}

LevelSet fit_full(const Problem& problem, SsdReport& report) {
  const Hierarchy hierarchy =
      choose_hierarchy(problem.box, report.spacing, problem.params.padding, problem.tables.width());
  std::vector<SsdSample> samples = touched<SsdSample>(problem.cloud.points.size());
  tbb::parallel_for(std::size_t{0}, samples.size(),
                    [&](std::size_t i) { samples[i] = sample_of(problem, hierarchy.finest, i); });
  return fit_lattice(problem, hierarchy, std::move(samples), problem.params.tolerance, report);
}

// Cells of the coarsest lattice around the samples: functions near its wall are deformed, and those of a band, which
// are not, must not reach them.
constexpr int kLeastMultilevelPadding = 5;
// A lattice that no band follows is solved to this many times the tolerance: psi is then far nearer to its limit than
// the samples are to psi. One with bands is solved to the tolerance itself, because bands take up what it leaves over
// only around samples, and only down to a tenth of it (band_tolerance).
constexpr double kLoneTolerance = 5;
// Samples are merged in half-spacing cubes on every level.
constexpr double kMergeCube = 0.5;
// Fields of SsdParams, as messages name them.
constexpr Option kDetail{"detail"}, kMaxMemory{"max_memory"};

// A sample that stands for more than 4 h^2 has no neighbour within about 2 h.
constexpr double kMostArea = 4;

// Bytes per node of the coarsest lattice (multigrid) and per point (cloud, areas, samples, merging); and what the level
// set keeps of a band over what its solve takes. About what is held at the peak.
constexpr double kBytesPerCoarseNode = 250, kBytesPerPoint = 200, kKept = 0.6;

// The samples of the coarsest lattice, and of each of twice its resolution, in the units of theirs.
struct LevelSamples {
  std::vector<std::vector<SsdSample>> here;  // but for those that SsdParams::bands has taken
  std::vector<std::size_t> n;
  std::vector<double> bytes;  // of bands: SsdBand::expected_bytes(), where there is a limit
};

void require_memory(const Problem& problem, const Hierarchy& hierarchy, const LevelSamples& samples) {
  const double limit = problem.params.max_memory;
  if (limit == 0) return;
  double need = kBytesPerPoint * static_cast<double>(problem.cloud.points.size()) +
                kBytesPerCoarseNode * static_cast<double>(hierarchy.finest.size());
  const std::size_t n_levels = samples.bytes.size();
  for (std::size_t level = 1; level < n_levels; ++level) {
    need += level + 1 < n_levels ? kKept * samples.bytes[level] : (1 + kKept) * samples.bytes[level];
  }
  if (need <= limit) return;
  throw SolveTooLarge(formatted("a finest spacing of %.4g needs %.3g GB of memory, %.3g GB are allowed",
                                hierarchy.finest.h / std::exp2(n_levels - 1.0), need / 1e9, limit / 1e9),
                      {{Change::Lower, kDetail, "for a larger spacing"}, {Change::Raise, kMaxMemory}});
}

Lattice refined(Lattice lattice, int times) {
  lattice.h = std::ldexp(lattice.h, -times);
  lattice.n = (lattice.n.array() - 1) * (1 << times) + 1;
  return lattice;
}

LevelSamples samples_of_levels(const Problem& problem, const Lattice& coarsest, int n_bands) {
  const SsdParams& params = problem.params;
  const int half_width = problem.tables.half_width();
  const auto n_levels = static_cast<std::size_t>(n_bands) + 1;
  LevelSamples made{std::vector<std::vector<SsdSample>>(n_levels), std::vector<std::size_t>(n_levels, 0),
                    std::vector<double>(n_levels, 0)};
  const auto take = [&](int level, std::vector<SsdSample> samples) {
    made.n[level] = samples.size();
    if (params.max_memory > 0) made.bytes[level] = SsdBand::expected_bytes(samples, half_width);
    if (!params.bands) {
      made.here[level] = std::move(samples);
    } else if (!samples.empty()) {
      params.bands->take(level, refined(coarsest, level), half_width, std::move(samples));
    }
  };
  const Lattice finest = refined(coarsest, n_bands);
  std::vector<SsdSample> samples = merge_samples(
      problem.cloud.points.size(), [&](std::size_t i) { return sample_of(problem, finest, i); }, kMergeCube);
  for (int level = n_bands; level > 0; --level) {
    const double h = std::ldexp(finest.h, n_bands - level + 1);
    const double per_gradient = std::pow(h / value_length(h, params.noise), 2);
    const auto coarser = [&](std::size_t i) {
      SsdSample s = coarsened(samples[i]);
      s.w_value = s.w_gradient * per_gradient;
      return s;
    };
    std::vector<SsdSample> next = merge_samples(samples.size(), coarser, kMergeCube);
    take(level, resolved_samples(std::move(samples), kMostArea));
    samples = std::move(next);
  }
  made.here[0] = std::move(samples);
  return made;
}

double n_coarsest_nodes(const Problem& problem, double spacing) {
  const int padding = std::max(problem.params.padding, kLeastMultilevelPadding);
  return (problem.box.sizes() / spacing + Vec3::Constant(2 * padding)).prod();
}

// SsdParams::finest, or less where a full lattice may be finer.
double finest_of_use(const Problem& problem) {
  constexpr int kHalvings = 50;  // the digits of a double
  double low = 0, high = problem.params.finest;
  for (int k = 0; k < kHalvings && high > 0; ++k) {
    const double middle = low + (high - low) / 2;
    (n_coarsest_nodes(problem, middle) > problem.params.coarsest_nodes ? low : high) = middle;
  }
  return high;
}

LevelSet fit_multilevel(const Problem& problem, SsdReport& report) {
  const SsdParams& params = problem.params;
  const int padding = std::max(params.padding, kLeastMultilevelPadding);
  int n_bands = 0;
  double coarsest = report.spacing;
  while (n_coarsest_nodes(problem, coarsest) > params.coarsest_nodes) {
    coarsest *= 2;
    ++n_bands;
  }
  LevelSamples samples;
  const auto fit_coarsest = [&](const Eigen::AlignedBox3d& box, const ClosingPlan* closing, bool with_wall = false) {
    const Hierarchy hierarchy = choose_hierarchy(box, coarsest, padding, problem.tables.width());
    samples = samples_of_levels(problem, hierarchy.finest, n_bands);
    require_memory(problem, hierarchy, samples);
    std::vector<SsdSample> all = samples.here[0];
    if (closing) {
      const std::vector<SsdSample> more = closing->samples(hierarchy.finest);
      all.insert(all.end(), more.begin(), more.end());
    }
    if (with_wall) {
      const std::vector<SsdSample> more = wall_samples(hierarchy.finest, samples.here[0]);
      all.insert(all.end(), more.begin(), more.end());
    }
    return fit_lattice(problem, hierarchy, std::move(all), (n_bands > 0 ? 1 : kLoneTolerance) * params.tolerance,
                       report);
  };
  LevelSet psi = fit_coarsest(problem.box, nullptr);
  if (params.bounded && least_wall_value(psi) < 0) psi = fit_coarsest(problem.box, nullptr, true);
  const ClosingPlan closing(psi, std::move(samples.here[0]), params.closing);
  if (closing.is_needed()) psi = fit_coarsest(closing.box(), &closing);
  report.holes = closing.holes();
  samples.here[0] = {};
  for (int level = 1; level <= n_bands && samples.n[level] > 0; ++level) {
    const double per_level = 1.0 / n_bands;
    const double smoothing = level < n_bands ? report.smoothing : problem.finest_smoothing;
    BandReport band;
    const auto go_on = [&](double residual) {
      const double done = std::clamp(std::log(residual) / std::log(params.band_tolerance), 0.0, 1.0);
      problem.context.report("refine", kRefine + (1 - kRefine) * (level - 1 + done) * per_level);
    };
    psi = params.bands
              ? params.bands->refine(psi, smoothing, params.band_tolerance, params.max_iterations, go_on, band)
              : refine(psi, samples.here[level], smoothing, params.band_tolerance, params.max_iterations, go_on, band);
    if (!band.converged) {
      throw SolveError(
          formatted("band of %zu nodes, smoothing %.3g: relative residual %.2e after %d iterations, "
                    "wanted %.1e",
                    band.n_nodes, smoothing, band.residual, band.iterations, params.band_tolerance));
    }
    samples.here[level] = {};
    report.n_nodes += band.n_nodes;
    report.bands.push_back(band);
  }
  report.spacing = psi.spacing();
  return psi;
}

}  // namespace

SsdFit fit_ssd(const OrientedPointCloud& cloud, const SsdParams& params, const Context& context,
               const NeighbourDistances* near) {
  const std::vector<std::string> wrong = problems(params);
  if (!wrong.empty()) throw std::invalid_argument(joined(wrong, "; "));
  if (cloud.points.size() < 10 || cloud.points.size() != cloud.normals.size()) {
    throw std::invalid_argument(
        formatted("a cloud needs at least 10 points with a normal each; this one has %zu points and %zu normals",
                  cloud.points.size(), cloud.normals.size()));
  }
  if (near && near->nearest.size() != cloud.points.size()) {
    throw std::invalid_argument(
        formatted("neighbours of %zu points, the cloud has %zu", near->nearest.size(), cloud.points.size()));
  }
  if (!params.local_noise.empty() && params.local_noise.size() != cloud.points.size()) {
    throw std::invalid_argument(
        formatted("noise of %zu points, the cloud has %zu", params.local_noise.size(), cloud.points.size()));
  }
  SsdReport report;
  report.n_points = cloud.points.size();

  context.report("weights", 0);
  Problem problem{cloud, params, context, LmeTables(params.prior), {}, {}, {}, 0};
  for (const Vec3& x : cloud.points) problem.box.extend(x);
  const double diagonal = problem.box.diagonal().norm();
  double between_samples = 0;
  {
    const NeighbourDistances searched = near ? NeighbourDistances{} : covered_distances(cloud.points, cloud.counts);
    const NeighbourDistances& found = near ? *near : searched;
    report.cloud_spacing = median_spacing(found);
    problem.area = sample_areas(found);
    problem.n_share = found.multiplicity;
    between_samples = sample_spacing(found);
  }
  const double edge = kMeshEdge * diagonal;
  const Resolution chosen =
      choose_resolution(between_samples, edge, params.noise, params.detail, params.smooth, finest_of_use(problem));
  report.spacing = params.spacing > 0 ? params.spacing : chosen.spacing;
  if (params.spacing == 0 && params.solver != SsdSolver::Multilevel) {
    report.spacing = std::max(report.spacing, edge);
  }
  report.smoothing = params.smoothing > 0 ? params.smoothing : chosen.smoothing;
  problem.finest_smoothing = params.smoothing > 0 ? params.smoothing : chosen.finest_smoothing;
  report.noise_decided = chosen.noise_decides && params.spacing == 0;
  report.reason = chosen.reason;
  if (params.weights == SsdWeights::Paper) problem.area = {};
  if (report.spacing > diagonal) {
    throw SolveError(formatted("spacing %.6g is larger than the cloud (diagonal %.6g): choose a smaller one",
                               report.spacing, diagonal));
  }
  context.report("setup", kSetup);
  LevelSet psi = params.solver == SsdSolver::Multilevel ? fit_multilevel(problem, report) : fit_full(problem, report);
  measure_fit(cloud, psi, problem.area, finest_value_length(report.spacing, params.noise), report);
  return {std::move(psi), std::move(report)};
}

}  // namespace umtet
