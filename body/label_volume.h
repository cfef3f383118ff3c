#pragma once

#include <vector>

#include "body/body.h"
#include "body/label_report.h"
#include "common/context.h"
#include "mesh/core/tet_mesh.h"
#include "reconstruct/level_set/mask_fit.h"

namespace umtet {

/// The voxels of a segmentation from which psi was made.
struct LabelVolume {
  BodyVoxels voxels;
  std::vector<Vec3> surface;  ///< points with psi = 0 between neighbouring voxels
  LabelVolumeReport report;   ///< the values that do not depend on a mesh

  /// The smallest step between voxels, model units.
  double step() const { return voxels.steps().minCoeff(); }
  double diagonal = 0;        ///< diagonal of the box around the body's voxels, model units
  double area = 0;            ///< area of psi = 0, model units^2
  double mean_curvature = 0;  ///< integral of k1 + k2 over psi = 0, model units: positive where the body bulges
};

/// Returns the result of fit_mask() with the pieces, area and curvature of the body.
///
/// Integrals over psi = 0 are sums over its crossings with the lines between voxels (Cauchy and Crofton): along axis a
/// there are int |n_a| dA / (area of a voxel across a) crossings, so each crossing has the weight |n_a| times this
/// area, and the sums over the three axes add up to the integral.
/// @param kernel  the kernel of fit_mask_by_kernel(); empty if fit_mask() was used
LabelVolume label_volume(MaskFit& fit, std::optional<std::int64_t> part, std::optional<double> kernel);

/// Returns the report with the measurements of a mesh. A voxel is inside the mesh if its centre is in a tet. Distances
/// of changed voxels to the boundary of the mesh are in voxels along each axis.
/// \pre domain.labels is set, and domain.complement is false
LabelVolumeReport label_volume_report(const Domain& domain, const TetMesh& mesh, const std::vector<Triangle>& faces,
                                      const Context& context = {});

}  // namespace umtet
