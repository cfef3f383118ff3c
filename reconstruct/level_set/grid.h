#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Values at the nodes of a lattice, as read from a file: node (i, j, k) is at origin + axes (i, j, k).
struct Grid {
  Eigen::Vector3i n = Eigen::Vector3i::Zero();  ///< nodes along each axis
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< one column per axis: the step to the next node
  std::vector<double> values;    ///< first axis fastest
  bool is_whole = false;  ///< stored as integers, not floating point numbers; false does not exclude whole values

  std::size_t size() const { return static_cast<std::size_t>(n[0]) * n[1] * n[2]; }
  /// Distances between nodes along each axis, model units.
  Vec3 steps() const { return axes.colwise().norm().transpose(); }
};

/// All broken constraints; empty for a grid to which a level set can be fitted. Such a grid has six nodes along each
/// axis, linearly independent axes and finite values.
std::vector<std::string> problems(const Grid& grid);

/// Kind of data, as inferred from the values at the nodes.
enum class GridKind {
  Segmentation,  ///< whole numbers of parts, none negative
  LevelSet,      ///< negative inside, and the inside does not reach the wall of the grid
  Image,         ///< grey values; the user has to state which of them are inside
};

/// Classifies a grid by its values, however they are stored. Whole numbers with at most three distinct values are a
/// segmentation. With more distinct values they are an image if, along an axis, a node lies between its two neighbours
/// in value at more than a fifth of the nodes where the value changes: grey values pass through intermediate values,
/// whereas parts are adjacent. Otherwise they are a segmentation.
GridKind kind_of(const Grid& grid);

/// True if all values are whole numbers.
bool has_whole_values(const Grid& grid);

}  // namespace umtet
