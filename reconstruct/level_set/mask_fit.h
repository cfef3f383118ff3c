#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "reconstruct/level_set/body_voxels.h"
#include "reconstruct/level_set/grid.h"
#include "reconstruct/level_set/grid_fit.h"

namespace umtet {

/// Report on the voxels of a body.
struct MaskReport {
  std::size_t n_inside = 0;     ///< voxels of the body
  std::size_t n_changed = 0;    ///< voxels whose centre has changed to the other side of psi = 0
  double farthest_changed = 0;  ///< greatest distance from psi = 0 among them, model units
  double volume_of_voxels = 0;  ///< volume of all voxels, model units^3
  double volume = 0;            ///< volume of {psi < 0}
  int n_iterations = 0;         ///< iterations of the minimisation
};

/// Result of fit_mask() and fit_mask_by_kernel().
struct MaskFit {
  GridLevelSet psi;
  MaskReport report;
  BodyVoxels voxels;
  std::vector<Vec3> surface;  ///< zeros of psi between voxels that are neighbours along an axis, model coordinates
};

/// Fits a level set to a mask: the psi of least Hessian energy whose signs at the voxel centres are those of the mask,
///
///     min  1/2 sum |H psi|^2,   psi <= -m inside,   psi >= m outside,   |psi - d| <= one voxel,
///
/// with d the signed distance to the faces between inside and outside [Whitaker2000; Lempitsky2010]. The margin m is .1
/// voxels, at which surfaces are as smooth as without a margin, and .25 voxels where the body or a gap is thinner than
/// three voxels. Afterwards s m is added to psi, with an s for each component between -.9 and .9, so that each
/// component of the body has the volume of its voxels, provided that no centre changes sides. The coefficients
/// interpolate psi at the centres, so psi is C2.
///
/// Only voxels within five layers of a face are variables; beyond these, psi is d. The axes are taken as orthogonal.
/// The result does not depend on the number of threads.
/// @param part  the number of the body's voxels; none: all voxels that are not zero
/// \pre problems(grid) is empty
/// \throw std::invalid_argument if no voxel is inside
MaskFit fit_mask(const Grid& grid, std::optional<double> part);

/// Fits a level set to a mask by smoothing: signed distances to the voxels of the other side are convolved with a
/// Gaussian and interpolated. A flat side keeps its position. A ball of radius R loses about smooth^2 / R of R, in
/// steps, and features thinner than the kernel vanish.
/// @param smooth  standard deviation in steps of each axis, >= 0; below .7 the stairs of the voxels are visible
/// \pre, \throw  as fit_mask()
MaskFit fit_mask_by_kernel(const Grid& grid, std::optional<double> part, double smooth);

}  // namespace umtet
