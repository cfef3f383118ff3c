#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Values at the nodes of a lattice, as another program has left them: node (i, j, k) is at origin + axes (i, j, k).
struct Grid {
  Eigen::Vector3i n = Eigen::Vector3i::Zero();  ///< nodes along each axis
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< a column for each axis: the step to the next node
  std::vector<double> values;    ///< the first axis fastest
  bool is_whole = false;         ///< stored as integers, not as floating point numbers

  std::size_t size() const { return static_cast<std::size_t>(n[0]) * n[1] * n[2]; }
  /// Steps between nodes along each axis, model units.
  Vec3 steps() const { return axes.colwise().norm().transpose(); }
};

/// Every broken constraint; empty for a grid that a level set can be fitted to: six nodes along each axis, axes that
/// span space, finite values.
std::vector<std::string> problems(const Grid& grid);

/// True for integers of at most 256 different values, none of them negative: numbers of parts, not a field.
bool is_segmentation(const Grid& grid);

}  // namespace umtet
