#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "reconstruct/level_set/grid.h"
#include "reconstruct/level_set/grid_fit.h"
#include "reconstruct/level_set/voxel_distance.h"

namespace umtet {

/// The voxels of a body, cut out of an image with some layers of voxels around them. Voxel (i, j, k) has its centre at
/// origin + axes (i, j, k).
struct BodyVoxels {
  VoxelMask mask;
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();

  double voxel_volume() const;
  Vec3 steps() const { return axes.colwise().norm().transpose(); }
  Vec3 centre(int i, int j, int k) const { return origin + axes * Vec3(i, j, k); }
};

/// Cuts out what is inside. @param layers  around it, outside; where the image ends, its voxels end, too
/// @param part  the number of the body's voxels; none: all that is not zero
/// \throw std::invalid_argument  no voxel is inside
BodyVoxels body_voxels(const Grid& grid, std::optional<double> part, int layers);

/// What became of the voxels of a body.
struct MaskReport {
  std::size_t n_inside = 0;     ///< voxels of the body
  std::size_t n_changed = 0;    ///< voxels whose centre is on the other side of psi = 0 now
  double farthest_changed = 0;  ///< how far from psi = 0 the farthest of them is, model units
  double volume_of_voxels = 0;  ///< of all of them together, model units^3
  double volume = 0;            ///< of {psi < 0}
  int n_iterations = 0;         ///< of the search
};

struct MaskFit {
  GridLevelSet psi;
  MaskReport report;
  BodyVoxels voxels;
  std::vector<Vec3> surface;  ///< where psi = 0 between voxels that are neighbours along an axis, model coordinates
};

/// psi of a mask: the one of least Hessian energy whose signs at the centres of voxels are those of the mask,
///
///     min  1/2 sum |H psi|^2,   psi <= -m inside,   psi >= m outside,   |psi - d| <= one voxel,
///
/// d the signed distance to the faces between inside and outside [Whitaker2000; Lempitsky2010]. The margin m is .1
/// voxels, at which surfaces are as smooth as without any, and .25 voxels where the body or a gap is thinner than
/// three. Then psi + s m, with an s of each piece between -.9 and .9, gives each piece of the body the volume of its
/// voxels, as far as no centre changes sides. The coefficients interpolate psi at the centres, so psi is C2.
///
/// Only voxels within five layers of a face are searched; beyond, psi is d. The axes are taken as orthogonal.
/// The result does not depend on the number of threads.
/// @param part  the number of the body's voxels; none: all that is not zero
/// \pre problems(grid) is empty \throw std::invalid_argument  no voxel is inside
MaskFit fit_mask(const Grid& grid, std::optional<double> part);

/// psi of a mask by a kernel: signed distances to the voxels of the other side, made smooth by a Gaussian, and
/// interpolated. A flat side keeps its place; a ball of radius R loses about smooth^2 / R of it, in steps, and what is
/// thinner than the kernel vanishes.
/// @param smooth  standard deviation in steps of each axis, >= 0; with less than .7 the steps of the voxels show
/// \pre, \throw  as fit_mask()
MaskFit fit_mask_by_kernel(const Grid& grid, std::optional<double> part, double smooth);

}  // namespace umtet
