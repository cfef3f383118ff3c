#pragma once

#include <vector>

#include "body/body.h"
#include "body/label_report.h"
#include "common/context.h"
#include "mesh/core/tet_mesh.h"
#include "reconstruct/level_set/mask_fit.h"

namespace umtet {

/// The voxels of a segmentation that psi was made of.
struct LabelVolume {
  BodyVoxels voxels;
  std::vector<Vec3> surface;  ///< where psi = 0 between neighbouring voxels
  LabelVolumeReport report;   ///< all that is known without a mesh

  /// The smallest step between voxels, model units.
  double step() const { return voxels.steps().minCoeff(); }
  double diagonal = 0;        ///< of the box around the body's voxels, model units
  double area = 0;            ///< of psi = 0, model units^2
  double mean_curvature = 0;  ///< integral of k1 + k2 over psi = 0, model units: positive where the body bulges
};

/// What fit_mask() returned, with its pieces, area and curvature.
///
/// Integrals over psi = 0 are sums over its crossings with the lines between voxels (Cauchy and Crofton): along axis a
/// there are int |n_a| dA / (area of a voxel across a) of them, so one stands for |n_a| times that area.
/// @param kernel  of fit_mask_by_kernel()
LabelVolume label_volume(MaskFit& fit, std::optional<std::int64_t> part, std::optional<double> kernel);

/// The report with what is measured of a mesh: a voxel is inside of it if its centre is in a tet. Distances of voxels
/// that changed sides are in steps along each axis, to the boundary of the mesh. \pre domain.labels, not the complement
LabelVolumeReport label_volume_report(const Domain& domain, const TetMesh& mesh, const std::vector<Triangle>& faces,
                                      const Context& context = {});

}  // namespace umtet
