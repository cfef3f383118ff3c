#include "reconstruct/fit_ssd.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "reconstruct/cloud_neighbours.h"
#include "reconstruct/multigrid.h"
#include "reconstruct/ssd_assembled.h"

namespace umtet {

std::vector<std::string> problems(const SsdParams& params) {
  std::vector<std::string> p = problems(params.prior);
  if (!(params.spacing >= 0 && std::isfinite(params.spacing))) p.push_back("spacing must be >= 0 (0: automatic)");
  if (!(params.smoothing > 0)) p.push_back("smoothing must be > 0");
  if (!(params.alpha > 0)) p.push_back("alpha must be > 0");
  if (!(params.tolerance > 0 && params.tolerance < 1)) p.push_back("tolerance must be in (0, 1)");
  if (params.max_iterations < 1) p.push_back("max_iterations must be >= 1");
  if (params.padding < 1) p.push_back("padding must be >= 1");
  return p;
}

namespace {

constexpr std::ptrdiff_t kDenseNodes = 3000;       // more are never factored densely on the coarsest lattice
constexpr double kMostNodes = 1e9;                 // a full lattice holds no more: about 200 bytes each
constexpr std::ptrdiff_t kAssembledNodes = 16000;  // more are never factored at all: a minute already

// Seconds of one core, measured: a solve per node of the finest lattice; a dense Cholesky factor per node cubed.
constexpr double kSolveSeconds = 4.5e-6, kFactorSeconds = 4e-11;

// Halvings enough for the longest axis that can be asked for.
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
        fmt::format("spacing {:.6g} asks for {:.3g} lattice nodes: choose a larger one", h, wanted.prod()));
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
        fmt::format("spacing {:.6g} asks for a lattice of {:.0f} x {:.0f} x {:.0f} cells, too many or too "
                    "unlike for multigrid: choose a larger spacing",
                    h, wanted[0], wanted[1], wanted[2]));
  }
  return best;
}

// As fine as an edge of the default mesh (1.5 % of the diagonal: what the mesh can show), but not finer than the
// samples can tell.
double automatic_spacing(double cloud_spacing, double diagonal) {
  return std::max(0.75 * cloud_spacing, 0.015 * diagonal);
}

// @param area  a_i; empty for the paper's weights
std::vector<SsdSample> make_samples(const OrientedPointCloud& cloud, const std::vector<double>& area,
                                    const Lattice& lattice) {
  const double h = lattice.h;
  std::vector<SsdSample> samples(cloud.points.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].xi = (cloud.points[i] - lattice.origin) / h;
    samples[i].normal = cloud.normals[i];
    // With f = h F and x = h xi, both functionals divided by h² (area) or as they stand (paper):
    samples[i].w_value = area.empty() ? h * h : area[i] / (h * h);
    samples[i].w_gradient = area.empty() ? 1.0 : area[i] / (h * h);
  }
  return samples;
}

void measure_fit(const OrientedPointCloud& cloud, const LevelSet& psi, SsdReport& report) {
  double sum2 = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    Vec3 gradient;
    sum2 += std::pow(psi.evaluate(cloud.points[i], &gradient, nullptr), 2);
    report.n_opposed_normals += gradient.dot(cloud.normals[i]) < 0;
  }
  report.rms_value = std::sqrt(sum2 / static_cast<double>(cloud.points.size()));

  constexpr int kWallSamples = 16;  // along each edge of a face
  report.least_wall_value = std::numeric_limits<double>::infinity();
  const Eigen::AlignedBox3d& box = psi.domain();
  for (int face = 0; face < 6; ++face) {
    for (int s = 0; s < kWallSamples * kWallSamples; ++s) {
      Vec3 t;  // position in the box, 0 .. 1 on each axis
      t[face / 2] = face % 2;
      t[(face / 2 + 1) % 3] = (s % kWallSamples + 0.5) / kWallSamples;
      t[(face / 2 + 2) % 3] = (s / kWallSamples + 0.5) / kWallSamples;
      report.least_wall_value = std::min(report.least_wall_value, psi.value(box.min() + t.cwiseProduct(box.sizes())));
    }
  }
}

void go_on(const SsdProgress& progress, const char* step, double fraction) {
  if (progress && !progress(step, fraction)) throw SolveCancelled(fmt::format("stopped during {}", step));
}

// Coefficients in units of the spacing, by the solver that was asked for.
std::vector<double> solve(const SsdOperator& op, int n_levels, const SsdParams& params, const SsdProgress& progress,
                          SsdReport& report) {
  if (params.solver == SsdSolver::Assembled) {
    if (op.size() > kAssembledNodes) {
      throw SolveError(
          fmt::format("the assembled solver is for up to {} nodes, this lattice has {}: use multigrid or a larger "
                      "spacing",
                      kAssembledNodes, op.size()));
    }
    return solve_assembled(op);
  }
  Multigrid multigrid(op, n_levels);
  std::vector<double> c, r(op.size() + SsdOperator::kPad, 0.0);
  op.right_hand_side(r.data());
  go_on(progress, "solve", 0);
  const PcgReport pcg = solve_pcg(op, multigrid, r, params.tolerance, params.max_iterations, c, [&](double residual) {
    go_on(progress, "solve", std::clamp(std::log(residual) / std::log(params.tolerance), 0.0, 1.0));
  });
  report.iterations = pcg.iterations;
  report.residuals = pcg.residuals;
  if (!pcg.converged) {
    throw SolveError(
        fmt::format("{} nodes, smoothing {:.3g}: relative residual {:.2e} after {} iterations, wanted {:.1e}",
                    op.size(), op.kappa(), pcg.residuals.back(), pcg.iterations, params.tolerance));
  }
  return c;
}

}  // namespace

SsdFit fit_ssd(const OrientedPointCloud& cloud, const SsdParams& params, const SsdProgress& progress) {
  const std::vector<std::string> wrong = problems(params);
  if (!wrong.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(wrong, "; ")));
  if (cloud.points.size() < 10 || cloud.points.size() != cloud.normals.size()) {
    throw std::invalid_argument(
        fmt::format("a cloud needs at least 10 points with a normal each; this one has {} points and {} normals",
                    cloud.points.size(), cloud.normals.size()));
  }
  SsdReport report;
  report.n_points = cloud.points.size();

  go_on(progress, "weights", 0);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.points) box.extend(x);
  const NeighbourDistances near = neighbour_distances(cloud.points, kAreaNeighbours);
  report.cloud_spacing = median_spacing(near);
  report.spacing = params.spacing > 0 ? params.spacing : automatic_spacing(report.cloud_spacing, box.diagonal().norm());
  if (report.spacing > box.diagonal().norm()) {
    throw SolveError(fmt::format("spacing {:.6g} is larger than the cloud (diagonal {:.6g}): choose a smaller one",
                                 report.spacing, box.diagonal().norm()));
  }
  const LmeTables tables(params.prior);
  const auto [lattice, n_levels] = choose_hierarchy(box, report.spacing, params.padding, tables.width());
  report.n_nodes = lattice.size();
  const double kappa = params.weights == SsdWeights::Area ? params.smoothing : params.alpha * lattice.h;

  go_on(progress, "setup", 0);
  const std::vector<double> area = params.weights == SsdWeights::Area ? sample_areas(near) : std::vector<double>{};
  const SsdOperator op(tables, lattice.n, kappa, make_samples(cloud, area, lattice));
  std::vector<double> c = solve(op, n_levels, params, progress, report), workspace;
  c.resize(op.size() + SsdOperator::kPad, 0.0);
  const Eigen::Vector3d energies = op.energies(c.data(), workspace);
  // Back to model units: E = h² times the lattice functional for area weights; eq. (10) is written in its own units.
  const double unit = params.weights == SsdWeights::Area ? lattice.h * lattice.h : 1;
  report.energy_value = unit * energies[0];
  report.energy_normal = unit * energies[1];
  report.energy_hessian = unit * energies[2];

  c.resize(op.size());
  for (double& v : c) v *= lattice.h;
  LevelSet psi(params.prior, {{lattice, std::move(c)}});
  measure_fit(cloud, psi, report);
  return {std::move(psi), std::move(report)};
}

}  // namespace umtet
