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
  bool is_whole = false;  ///< stored as integers, not as floating point numbers: the values may be whole without it

  std::size_t size() const { return static_cast<std::size_t>(n[0]) * n[1] * n[2]; }
  /// Steps between nodes along each axis, model units.
  Vec3 steps() const { return axes.colwise().norm().transpose(); }
};

/// Every broken constraint; empty for a grid that a level set can be fitted to: six nodes along each axis, axes that
/// span space, finite values.
std::vector<std::string> problems(const Grid& grid);

/// What the values at the nodes are, as far as they tell.
enum class GridKind {
  Segmentation,  ///< whole numbers of parts, none of them negative
  LevelSet,      ///< negative inside, and what is inside does not reach the wall of the grid
  Image,         ///< grey values: which of them are inside has to be said
};

/// By the values, however they are stored. Whole numbers of at most three kinds are a segmentation. Of more kinds they
/// are an image where, along an axis, a node has a value between those of its two neighbours at more than a fifth of
/// the nodes where the value changes: grey values rise through what is between, and parts are next to one another.
GridKind kind_of(const Grid& grid);

/// True where all values are whole numbers.
bool has_whole_values(const Grid& grid);

}  // namespace umtet
