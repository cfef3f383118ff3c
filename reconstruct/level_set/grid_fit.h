#pragma once

#include "reconstruct/level_set/grid.h"
#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Level set function fitted to a grid. It is defined in the coordinates (i, j, k) of the grid's nodes, which may be
/// stretched, rotated and sheared against model coordinates. C2; satisfies the mesher's ImplicitFunction; thread-safe.
class GridLevelSet {
 public:
  /// @param psi  function of node coordinates, with values in model units
  GridLevelSet(LevelSet psi, const Vec3& origin, const Mat3& axes);

  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  /// Bounding box of all nodes, model coordinates.
  const Eigen::AlignedBox3d& box() const { return box_; }
  /// The same function in node coordinates.
  const LevelSet& in_nodes() const { return psi_; }

 private:
  LevelSet psi_;
  Vec3 origin_;
  Mat3 to_nodes_;  ///< (i, j, k) = to_nodes (x - origin)
  Eigen::AlignedBox3d box_;
};

/// Interpolation of a grid by max-ent functions of the default prior: their sum has the given values at the nodes.
/// Solves one banded system per axis.
///
/// Between the nodes, linear functions are reproduced to rounding. Other functions have a ripple of about half a
/// hundredth of the second differences of the values.
/// \pre problems(grid) is empty
GridLevelSet interpolate(Grid grid);

}  // namespace umtet
