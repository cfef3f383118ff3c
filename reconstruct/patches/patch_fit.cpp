#include "reconstruct/patches/patch_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>

#include "common/polled_loops.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/patches/nested_dissection.h"
#include "reconstruct/patches/spline_band.h"

namespace umtet {
namespace {

// Weight of a normal beside a position that is off by s. Root mean square of a curve on a torus of 8 s with normals off
// by 5, 10 and 20 degrees, in s: .033, .060, .13 with .1; .031, .057, .11 with 1.
constexpr double kNormalWeight = 1;
// The energy of second derivatives decides what a plane leaves open, such as z^2: small beside every lambda.
constexpr double kEpsilon = 1e-4;
constexpr int kRings = 1;  // of cells around those with samples; two take four times as long and are no better
constexpr std::size_t kFitNeighbours = 12;
// The 90th percentile of |mean| of normal numbers, and the spread of this percentile over patches: the means of m
// samples count as about m / 6 independent ones, and 1.8 standard deviations of theirs leave no plane out.
constexpr double kPercentile = 1.645, kSpread = 2.7, kIndependent = 6;
constexpr double kMisfitFloor = .01;  // in s: a smaller misfit needs no explanation
// A quadric explains the samples of a plane no better than by chance: the F statistic of its six more coefficients
// exceeds 4 in one of a thousand.
constexpr double kMostF = 4, kFFloor = 1e-6;
// Curvatures of a quadric, in 1 / s, that are expected where the samples do not tell.
constexpr double kCurvature = .05, kLeastFitNoise = .02;
// A sample is no part of the patch if it is off by this many robust standard deviations, and by this part of s.
constexpr double kOutlier = 5, kOutlierOff = .5;
constexpr double kLeastSlope = 1e-3;  // of f at a sample
// A sample whose fourth neighbour of the patch is farther is alone: in the corner of a square it is about 2.2 s away.
constexpr std::size_t kCompany = 4;
constexpr double kAlone = 2.5;
constexpr double kMostOutliers = .05;  // of the samples: more of them are misfit

/// Weights of the splines, with cells that resolve what each weight leaves: on a surface with one sample in s^2, a wave
/// of length L is halved where lambda (2 pi s / L)^5 = 1, which for lambda = .1 is L = 4 s.
struct Smoothness {
  double lambda, cell;
};
constexpr Smoothness kSmoothness[] = {{1e4, 8}, {1e3, 6}, {1e2, 4}, {10, 2.5}, {1, 2}, {.1, 2}};

double square(double x) { return x * x; }

/// c + g . x + x . H x / 2, lengths in units of s.
struct Quadric {
  double c = 0;
  Vec3 g = Vec3::Zero();
  Mat3 H = Mat3::Zero();
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
    const Vec3 Hx = H * x;
    if (gradient) *gradient = g + Hx;
    if (hessian) *hessian = H;
    return c + x.dot(g) + .5 * x.dot(Hx);
  }
};

/// Samples with the lengths in units of s, around their mean.
struct Scaled {
  std::vector<Vec3> x, n;
  double noise;
};

Quadric fit_plane(const Scaled& at) {
  Mat3 M = Mat3::Zero();
  Vec3 sum = Vec3::Zero(), mean = Vec3::Zero();
  for (const Vec3& x : at.x) mean += x / static_cast<double>(at.x.size());
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    M += (at.x[i] - mean) * (at.x[i] - mean).transpose() - kNormalWeight * at.n[i] * at.n[i].transpose();
    sum += at.n[i];
  }
  // The unit normal with the least sum of (n . (x_i - mean))^2 - w (n . n_i)^2.
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(M);
  Vec3 n = solver.eigenvectors().col(0);
  if (n.dot(sum) < 0) n = -n;
  return {-n.dot(mean), n, Mat3::Zero()};
}

Quadric fit_quadric(const Scaled& at) {
  using Row = Eigen::Matrix<double, 10, 1>;
  Eigen::Matrix<double, 10, 10> A = Eigen::Matrix<double, 10, 10>::Zero();
  Row b = Row::Zero();
  double spread = 0;
  for (const Vec3& x : at.x) spread += x.squaredNorm();
  const double R = std::max(1., std::sqrt(spread / static_cast<double>(at.x.size())));  // unit of lengths in here
  const double w = kNormalWeight / (R * R);
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    const Vec3 x = at.x[i] / R;
    Row v;
    v << 1, x, .5 * x.cwiseProduct(x), x.y() * x.z(), x.x() * x.z(), x.x() * x.y();
    A += v * v.transpose();
    Eigen::Matrix<double, 10, 3> d = Eigen::Matrix<double, 10, 3>::Zero();
    d.middleRows<3>(1).setIdentity();
    d.middleRows<3>(4) = x.asDiagonal();
    d.row(7) << 0, x.z(), x.y();
    d.row(8) << x.z(), 0, x.x();
    d.row(9) << x.y(), x.x(), 0;
    A += w * d * d.transpose();
    b += w * R * d * at.n[i];
  }
  const double sigma = std::max(at.noise, kLeastFitNoise);
  const double ridge = sigma * sigma / (kCurvature * kCurvature) / std::pow(R, 4);
  for (int k = 4; k < 10; ++k) A(k, k) += (k < 7 ? 1 : 2) * ridge;
  const Row q = A.ldlt().solve(b);
  Quadric f;
  f.c = q[0];
  f.g = q.segment<3>(1) / R;
  f.H << q[4], q[9], q[8], q[9], q[5], q[7], q[8], q[7], q[6];
  f.H /= R * R;
  return f;
}

struct Splines {
  SplineBand band;
  std::vector<double> c;
};

std::optional<Splines> fit_splines(const Scaled& at, const Smoothness& smoothness) {
  Splines f{SplineBand(at.x, smoothness.cell, kRings), {}};
  std::vector<std::vector<std::uint32_t>> samples(f.band.n_cells());
  for (std::size_t i = 0; i < at.x.size(); ++i)
    samples[f.band.cell_of(at.x[i])].push_back(static_cast<std::uint32_t>(i));
  const Eigen::MatrixXd energy = smoothness.lambda * f.band.energy(3) + kEpsilon * f.band.energy(2);
  ElementSystem system;
  system.n_unknowns = f.band.n_nodes();
  for (int c = 0; c < f.band.n_cells(); ++c) {
    system.centres.push_back(f.band.centre(c));
    system.unknowns.emplace_back(f.band.nodes(c).begin(), f.band.nodes(c).end());
  }
  system.add = [&](int cell, Eigen::MatrixXd& A, Eigen::VectorXd& b) {
    A += energy;
    if (samples[cell].empty()) return;
    Eigen::MatrixXd rows(SplineBand::kNodes, 4 * samples[cell].size());
    Eigen::Index column = 0;
    for (const std::uint32_t i : samples[cell]) {
      SplineBand::Functions B;
      f.band.functions(cell, at.x[i], B);
      b += kNormalWeight * B.rightCols(3) * at.n[i];
      B.rightCols(3) *= std::sqrt(kNormalWeight);
      rows.middleCols(column, 4) = B;
      column += 4;
    }
    A.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  };
  const Eigen::VectorXd c = solve_by_nested_dissection(system);
  if (c.size() == 0 || !c.allFinite()) return std::nullopt;
  f.c.assign(c.data(), c.data() + c.size());
  return f;
}

}  // namespace

struct PatchFit::Parts {
  Vec3 mean = Vec3::Zero();
  double s = 1;
  Kind kind = Kind::Plane;
  double weight = std::numeric_limits<double>::infinity(), misfit = 0;
  Quadric quadric;
  std::optional<Splines> splines;
  Scaled at;
  std::optional<NeighbourTree> tree;  ///< of at.x
  std::vector<double> r;              ///< residuals of the last function that was judged

  double evaluate(const Vec3& y, Vec3* g, Mat3* H) const {
    if (kind != Kind::Splines) return quadric.evaluate(y, g, H);
    const int cell = splines->band.cell_of(y);
    if (cell >= 0) return splines->band.evaluate(splines->c, cell, y, g, H);
    std::array<Neighbour, 1> room;
    const Vec3& from = at.x[tree->k_nearest(y, room)[0].point];
    Quadric taylor;
    taylor.c = splines->band.evaluate(splines->c, splines->band.cell_of(from), from, &taylor.g, &taylor.H);
    return taylor.evaluate(y - from, g, H);
  }

  double sum_of_squares() const { return std::inner_product(r.begin(), r.end(), r.begin(), 0.); }

  /// Measures the residuals of the function. \return whether they are noise
  bool judge(const Neighbourhoods* near) {
    const double m = static_cast<double>(at.x.size());
    r.resize(at.x.size());
    for (std::size_t i = 0; i < r.size(); ++i) {
      Vec3 g;
      const double f = evaluate(at.x[i], &g, nullptr);
      r[i] = f / std::max(g.norm(), kLeastSlope);
    }
    if (!near) return true;
    const double n = static_cast<double>(near->k() + 1);
    double differences = 0;
    std::vector<double> mean(r.size());
    for (std::size_t i = 0; i < r.size(); ++i) {
      double sum = r[i];
      for (const std::uint32_t j : near->points(i)) {
        sum += r[j];
        differences += square(r[i] - r[j]);
      }
      mean[i] = std::abs(sum) / n;
    }
    const double variance = differences / (2 * m * (n - 1));
    const auto at90 = mean.begin() + static_cast<std::ptrdiff_t>(mean.size() * 9 / 10);
    std::nth_element(mean.begin(), at90, mean.end());
    const double allowed = kPercentile * (1 + kSpread * std::sqrt(kIndependent / m));
    misfit = *at90 / (allowed * std::sqrt(variance / n + square(kMisfitFloor)));
    return misfit <= 1;
  }

  void fit() {
    tree.emplace(at.x);
    std::optional<Neighbourhoods> some;
    if (at.x.size() > kFitNeighbours) some.emplace(*tree, kFitNeighbours - 1);
    const Neighbourhoods* near = some ? &*some : nullptr;
    const double m = static_cast<double>(at.x.size());
    kind = Kind::Plane;
    quadric = fit_plane(at);
    const bool is_plane = judge(near);
    if (!near) return;
    const Quadric plane = quadric;
    const double of_plane = sum_of_squares();
    kind = Kind::Quadric;
    quadric = fit_quadric(at);
    const bool is_quadric = judge(near);
    const double of_quadric = sum_of_squares();
    if (is_plane && of_plane - of_quadric <= 6 * kMostF * (of_quadric / (m - kFitNeighbours) + kFFloor)) {
      kind = Kind::Plane;
      quadric = plane;
      judge(near);
    } else if (!is_quadric) {
      fit_splines_to_noise(near);
    }
  }

  void fit_splines_to_noise(const Neighbourhoods* near) {
    bool is_noise = false;
    for (const Smoothness& smoothness : kSmoothness) {
      std::optional<Splines> f = fit_splines(at, smoothness);
      if (!f) continue;
      kind = Kind::Splines;
      splines = std::move(f);
      weight = smoothness.lambda;
      const bool was_noise = is_noise;
      is_noise = judge(near);
      if (was_noise) break;
    }
  }

  /// Takes samples out that are far from the others. They would bend all functions.
  void drop_isolated() {
    if (at.x.size() <= kCompany) return;
    std::vector<std::uint8_t> is_isolated(at.x.size(), 0);
    NeighbourTree(at.x).for_each_neighbourhood(kCompany + 1, [&](std::uint32_t i, std::span<const Neighbour> near) {
      is_isolated[i] = near.back().distance2 > square(kAlone) ? 1 : 0;
    });
    drop(is_isolated);
  }

  /// Takes samples out that are no part of the patch. \return whether there are some
  bool drop_outliers() {
    std::vector<double> off;
    for (const double f : r) off.push_back(std::abs(f));
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    const double most = std::max(kOutlier * 1.4826 * *middle, kOutlierOff);
    std::vector<std::uint8_t> is_off;
    for (const double f : r) is_off.push_back(std::abs(f) > most ? 1 : 0);
    return drop(is_off);
  }

  /// Takes some samples out, unless they are many. \return whether it did
  bool drop(const std::vector<std::uint8_t>& is_out) {
    const auto n = std::count(is_out.begin(), is_out.end(), 1);
    if (n == 0 || static_cast<double>(n) > kMostOutliers * static_cast<double>(is_out.size())) return false;
    Scaled kept{{}, {}, at.noise};
    for (std::size_t i = 0; i < is_out.size(); ++i) {
      if (is_out[i] != 0) continue;
      kept.x.push_back(at.x[i]);
      kept.n.push_back(at.n[i]);
    }
    at = std::move(kept);
    return true;
  }
};

PatchFit::PatchFit(const PatchSamples& samples) {
  if (samples.points.empty() || samples.points.size() != samples.normals.size() || !(samples.spacing > 0))
    throw std::invalid_argument("a patch needs samples with normals, and a spacing");
  auto parts = std::make_unique<Parts>();
  parts->s = samples.spacing;
  for (const Vec3& x : samples.points) parts->mean += x / static_cast<double>(samples.points.size());
  parts->at = {{}, samples.normals, samples.noise / samples.spacing};
  for (const Vec3& x : samples.points) parts->at.x.emplace_back((x - parts->mean) / parts->s);
  parts->drop_isolated();
  parts->fit();
  if (parts->drop_outliers()) parts->fit();
  parts_ = std::move(parts);
}

PatchFit::~PatchFit() = default;
PatchFit::PatchFit(PatchFit&&) noexcept = default;
PatchFit& PatchFit::operator=(PatchFit&&) noexcept = default;

double PatchFit::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const double f = parts_->evaluate((x - parts_->mean) / parts_->s, gradient, hessian);
  if (hessian) *hessian /= parts_->s;
  return parts_->s * f;
}

PatchFit::Kind PatchFit::kind() const { return parts_->kind; }
double PatchFit::weight() const { return parts_->weight; }
double PatchFit::misfit() const { return parts_->misfit; }
double PatchFit::residual() const {
  return parts_->s * std::sqrt(parts_->sum_of_squares() / static_cast<double>(parts_->r.size()));
}

std::vector<PatchFit> fit_patches(const std::vector<Vec3>& points, const SamplePatches& patches,
                                  const Context& context) {
  std::vector<PatchSamples> samples(patches.count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    samples[patches.patch[i]].points.push_back(points[i]);
    samples[patches.patch[i]].normals.push_back(patches.normals[i]);
  }
  std::vector<std::optional<PatchFit>> made(samples.size());
  polled_parallel_for(samples.size(), 1, context, [&](std::size_t p) {
    samples[p].spacing = patches.spacing;
    samples[p].noise = patches.noise;
    made[p].emplace(samples[p]);
  });
  std::vector<PatchFit> fits;
  fits.reserve(made.size());
  for (auto& fit : made) fits.push_back(std::move(*fit));
  return fits;
}

}  // namespace umtet
