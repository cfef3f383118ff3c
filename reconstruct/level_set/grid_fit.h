#pragma once

#include <cstddef>
#include <optional>

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

/// What became of a segmentation.
struct MaskReport {
  std::size_t n_inside = 0;     ///< voxels of the body
  std::size_t n_changed = 0;    ///< voxels whose centre is on the other side of psi = 0 now
  double farthest_changed = 0;  ///< how far from psi = 0 the farthest of them is, model units
};

struct MaskFit {
  GridLevelSet psi;
  MaskReport report;
};

/// psi of a segmentation: signed distances to the voxels of the other side, made smooth by a Gaussian, and
/// interpolated. A flat side keeps its place; a ball of radius R loses about smooth^2 / R of it, in steps.
/// @param part    the number of the body's voxels; none: all that is not zero
/// @param smooth  standard deviation in steps of each axis, >= 0; with less than .7 the steps of the voxels show
/// \pre problems(grid) is empty \throw std::invalid_argument  no voxel is inside, or all are
MaskFit fit_mask(Grid grid, std::optional<double> part, double smooth);

}  // namespace umtet
