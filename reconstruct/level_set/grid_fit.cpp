#include "reconstruct/level_set/grid_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "reconstruct/basis/lme_lattice.h"
#include "reconstruct/level_set/voxel_lines.h"

namespace umtet {
namespace {

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
  void solve(const VoxelLine<double>& v) const {
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
    for_each_line(grid.values, grid.n, axis, [&](const VoxelLine<double>& line) { system.solve(line); });
  }
  return {LevelSet(prior, {Lattice{Vec3::Zero(), 1, grid.n}, std::move(grid.values)}), grid.origin, grid.axes};
}

}  // namespace umtet
