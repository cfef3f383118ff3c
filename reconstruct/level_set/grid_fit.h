#pragma once

#include "reconstruct/level_set/grid.h"
#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// psi fitted to a grid: a level set in the coordinates (i, j, k) of the grid's nodes, which may be stretched, rotated
/// and sheared against those of the model. C2; satisfies the mesher's ImplicitFunction; thread-safe.
class GridLevelSet {
 public:
  /// @param psi  in node coordinates, values in model units
  GridLevelSet(LevelSet psi, const Vec3& origin, const Mat3& axes);

  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  /// Around all nodes, model coordinates.
  const Eigen::AlignedBox3d& box() const { return box_; }
  /// The same function of node coordinates.
  const LevelSet& in_nodes() const { return psi_; }

 private:
  LevelSet psi_;
  Vec3 origin_;
  Mat3 to_nodes_;  ///< (i, j, k) = to_nodes (x - origin)
  Eigen::AlignedBox3d box_;
};

/// The max-ent functions of the default prior whose sum has the given values at the nodes, by one banded system an
/// axis.
///
/// Between the nodes linear functions are met to rounding, of others there is a ripple of about half a hundredth of the
/// second differences of the values.
/// \pre problems(grid) is empty
GridLevelSet interpolate(Grid grid);

}  // namespace umtet
