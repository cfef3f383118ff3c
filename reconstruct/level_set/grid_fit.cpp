#include "reconstruct/level_set/grid_fit.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "reconstruct/basis/lme_lattice.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A Gaussian beyond so many standard deviations adds less than a thousandth.
constexpr double kReach = 3.5;

/// A line of values through the grid.
struct Line {
  double* at;
  std::ptrdiff_t stride;
  int n;
  double& operator[](int i) const { return at[i * stride]; }
};

/// f(line) for all lines along an axis, threads over them.
template <class F>
void for_each_line(std::vector<double>& values, const Eigen::Vector3i& n, int axis, const F& f) {
  const std::ptrdiff_t nx = n[0], nxy = nx * n[1];
  const std::ptrdiff_t stride = axis == 0 ? 1 : axis == 1 ? nx : nxy;
  const std::ptrdiff_t fast = axis == 0 ? nx : 1, slow = axis == 2 ? nx : nxy;
  const int n_fast = axis == 0 ? n[1] : n[0], n_slow = axis == 2 ? n[1] : n[2];
  tbb::parallel_for(0, n_slow, [&](int s) {
    for (int k = 0; k < n_fast; ++k) f(Line{values.data() + s * slow + k * fast, stride, n[axis]});
  });
}

/// The banded system of the functions of an axis at its nodes, factored. No pivots are needed: in each row the function
/// of the node itself outweighs all others.
class NodeSystem {
 public:
  NodeSystem(const LmePrior& prior, int n) : w_(half_width(prior)), rows_(static_cast<std::size_t>(n) * (2 * w_ + 1)) {
    for (int i = 0; i < n; ++i) {
      const LmeBasis1d basis = evaluate_lme_1d(prior, n, i);
      for (int k = 0; k < LmeBasis1d::kPackSize; ++k) {
        const int j = basis.first + k;
        if (std::abs(j - i) <= w_ && j < n) at(i, j) = basis.N[k];
      }
    }
    for (int i = 0; i < n; ++i) {
      for (int r = i + 1; r <= std::min(i + w_, n - 1); ++r) {
        const double factor = at(r, i) /= at(i, i);
        for (int j = i + 1; j <= std::min(i + w_, n - 1); ++j) at(r, j) -= factor * at(i, j);
      }
    }
  }
  void solve(const Line& v) const {
    for (int i = 1; i < v.n; ++i) {
      for (int j = std::max(0, i - w_); j < i; ++j) v[i] -= at(i, j) * v[j];
    }
    for (int i = v.n - 1; i >= 0; --i) {
      for (int j = i + 1; j <= std::min(i + w_, v.n - 1); ++j) v[i] -= at(i, j) * v[j];
      v[i] /= at(i, i);
    }
  }

 private:
  double& at(int i, int j) { return rows_[static_cast<std::size_t>(i) * (2 * w_ + 1) + (j - i + w_)]; }
  double at(int i, int j) const { return rows_[static_cast<std::size_t>(i) * (2 * w_ + 1) + (j - i + w_)]; }

  int w_;
  std::vector<double> rows_;
};

/// min over j of step^2 (i - j)^2 + v[j], the lower envelope of parabolas.         [FelzenszwalbHuttenlocher2012]
void spread_squares(const Line& v, double step) {
  const double step2 = step * step;
  std::vector<int> apex;
  std::vector<double> from, height;
  for (int q = 0; q < v.n; ++q) {
    if (v[q] == kInfinity) continue;
    double begin = -kInfinity;
    while (!apex.empty()) {
      const int p = apex.back();
      begin = ((v[q] - height.back()) / step2 + double(q) * q - double(p) * p) / (2. * (q - p));
      if (begin > from.back()) break;
      apex.pop_back(), from.pop_back(), height.pop_back();
      begin = -kInfinity;
    }
    apex.push_back(q), from.push_back(begin), height.push_back(v[q]);
  }
  if (apex.empty()) return;
  for (int i = 0, k = 0; i < v.n; ++i) {
    while (k + 1 < static_cast<int>(apex.size()) && from[k + 1] < i) ++k;
    v[i] = step2 * (i - apex[k]) * (i - apex[k]) + height[k];
  }
}

/// Distance of every node to the nearest one where `is_there`.
std::vector<double> distances(const Grid& grid, const std::vector<char>& inside, char is_there) {
  std::vector<double> d(inside.size());
  std::transform(inside.begin(), inside.end(), d.begin(), [&](char in) { return in == is_there ? 0 : kInfinity; });
  const Vec3 steps = grid.steps();
  for (int axis = 0; axis < 3; ++axis) {
    for_each_line(d, grid.n, axis, [&](const Line& line) { spread_squares(line, steps[axis]); });
  }
  for (double& v : d) v = std::sqrt(v);
  return d;
}

void blur(Grid& grid, double smooth) {
  const int reach = static_cast<int>(std::ceil(kReach * smooth));
  std::vector<double> weight;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    weight.push_back(smooth > 0 ? std::exp(-.5 * k * k / (smooth * smooth)) : 1);
    sum += weight.back();
  }
  for (int axis = 0; axis < 3 && reach > 0; ++axis) {
    for_each_line(grid.values, grid.n, axis, [&](const Line& line) {
      std::vector<double> v(static_cast<std::size_t>(line.n));
      for (int i = 0; i < line.n; ++i) v[i] = line[i];
      for (int i = 0; i < line.n; ++i) {
        double mean = 0;
        for (int k = -reach; k <= reach; ++k) mean += weight[k + reach] * v[std::clamp(i + k, 0, line.n - 1)];
        line[i] = mean / sum;
      }
    });
  }
}

/// With so many nodes more on each side, all of them zero.
Grid padded(const Grid& grid, int by) {
  Grid wide;
  wide.n = grid.n + Eigen::Vector3i::Constant(2 * by);
  wide.axes = grid.axes;
  wide.origin = grid.origin - grid.axes * Vec3::Constant(by);
  wide.values.assign(wide.size(), 0);
  for (int k = 0; k < grid.n[2]; ++k) {
    for (int j = 0; j < grid.n[1]; ++j) {
      const double* row = grid.values.data() + grid.n[0] * (j + static_cast<std::ptrdiff_t>(grid.n[1]) * k);
      std::copy_n(row, grid.n[0],
                  wide.values.data() + by + wide.n[0] * (j + by + static_cast<std::ptrdiff_t>(wide.n[1]) * (k + by)));
    }
  }
  return wide;
}

}  // namespace

GridLevelSet::GridLevelSet(LevelSet psi, const Vec3& origin, const Mat3& axes)
    : psi_(std::move(psi)), origin_(origin), to_nodes_(axes.inverse()) {
  const Vec3 last = psi_.domain().max();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 node(corner & 1 ? last.x() : 0, corner & 2 ? last.y() : 0, corner & 4 ? last.z() : 0);
    box_.extend(Vec3(origin + axes * node));
  }
}

double GridLevelSet::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const double value = psi_.evaluate(to_nodes_ * (x - origin_), gradient, hessian);
  if (gradient) *gradient = to_nodes_.transpose() * *gradient;
  if (hessian) *hessian = to_nodes_.transpose() * *hessian * to_nodes_;
  return value;
}

GridLevelSet interpolate(Grid grid) {
  const LmePrior prior;
  for (int axis = 0; axis < 3; ++axis) {
    const NodeSystem system(prior, grid.n[axis]);
    for_each_line(grid.values, grid.n, axis, [&](const Line& line) { system.solve(line); });
  }
  return {LevelSet(prior, {Lattice{Vec3::Zero(), 1, grid.n}, std::move(grid.values)}), grid.origin, grid.axes};
}

MaskFit fit_mask(Grid grid, std::optional<double> part, double smooth) {
  // Room for the mesh: what touches the wall of the image ends there.
  grid = padded(grid, 3 + static_cast<int>(std::ceil(kReach * smooth)));
  std::vector<char> inside(grid.size());
  std::transform(grid.values.begin(), grid.values.end(), inside.begin(),
                 [&](double v) { return part ? v == *part : v != 0; });
  MaskReport report;
  report.n_inside = static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
  if (report.n_inside == 0) throw std::invalid_argument("no voxel is inside");
  // Of a node on either side half a step less, so that psi = 0 is in the middle between the two sides.
  const double half = grid.steps().minCoeff() / 2;
  grid.values = distances(grid, inside, 1);
  {
    const std::vector<double> depth = distances(grid, inside, 0);
    for (std::size_t i = 0; i < inside.size(); ++i)
      grid.values[i] = inside[i] ? half - depth[i] : grid.values[i] - half;
  }
  blur(grid, smooth);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if ((grid.values[i] < 0) == (inside[i] != 0)) continue;
    ++report.n_changed;
    report.farthest_changed = std::max(report.farthest_changed, std::abs(grid.values[i]));
  }
  return {interpolate(std::move(grid)), report};
}

}  // namespace umtet
