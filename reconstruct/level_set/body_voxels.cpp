#include "reconstruct/level_set/body_voxels.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace umtet {

double BodyVoxels::voxel_volume() const { return std::abs(axes.determinant()); }

BodyVoxels body_voxels(const Grid& grid, std::optional<double> part, int layers) {
  const auto is_inside = [&](double v) { return part ? v == *part : v != 0; };
  const auto at = [&](int i, int j, int k) {
    return grid.values[i + grid.n[0] * (j + static_cast<std::size_t>(grid.n[1]) * k)];
  };
  Eigen::AlignedBox3i box;
  for (int k = 0; k < grid.n[2]; ++k) {
    for (int j = 0; j < grid.n[1]; ++j) {
      for (int i = 0; i < grid.n[0]; ++i)
        if (is_inside(at(i, j, k))) box.extend(Eigen::Vector3i(i, j, k));
    }
  }
  if (box.isEmpty()) throw std::invalid_argument("no voxel is inside");
  BodyVoxels body;
  const Eigen::Vector3i first = box.min() - Eigen::Vector3i::Constant(layers);
  body.mask.n = box.max() - first + Eigen::Vector3i::Constant(layers + 1);
  body.axes = grid.axes;
  body.origin = grid.origin + grid.axes * first.cast<double>();
  body.mask.inside.assign(static_cast<std::size_t>(body.mask.n[0]) * body.mask.n[1] * body.mask.n[2], 0);
  for (int k = box.min()[2]; k <= box.max()[2]; ++k) {
    for (int j = box.min()[1]; j <= box.max()[1]; ++j) {
      for (int i = box.min()[0]; i <= box.max()[0]; ++i)
        body.mask.inside[body.mask.index(i - first[0], j - first[1], k - first[2])] = is_inside(at(i, j, k)) ? 1 : 0;
    }
  }
  return body;
}

std::vector<Vec3> sign_changes(const BodyVoxels& voxels, const std::vector<float>& values) {
  std::vector<Vec3> points;
  const Eigen::Vector3i& n = voxels.mask.n;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const float here = values[voxels.mask.index(i, j, k)];
        for (int axis = 0; axis < 3; ++axis) {
          Eigen::Vector3i q(i, j, k);
          if (++q[axis] == n[axis]) continue;
          const float there = values[voxels.mask.index(q[0], q[1], q[2])];
          if ((here < 0) == (there < 0)) continue;
          Vec3 at(i, j, k);
          at[axis] += here / (here - there);
          points.push_back(voxels.origin + voxels.axes * at);
        }
      }
    }
  }
  return points;
}

}  // namespace umtet
