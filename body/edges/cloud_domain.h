#pragma once

#include <optional>
#include <vector>

#include "common/context.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/features/feature_graph.h"
#include "reconstruct/patches/sample_patches.h"

namespace umtet {

/// The piecewise smooth domain of a cloud with its curves and corners.
struct CloudDomain {
  PiecewiseDomain domain;
  FeatureGraph graph;
  std::vector<int> broken;  ///< corners of two patches, where a curve could not be followed further
};

/// The domain inside of a cloud that is divided into patches, with one function for each (patch_fit.h), and with the
/// curves and corners where they meet (feature_tracing.h). Patches whose borders are not sharp are one.
///
/// psi(x) is the function of the patch of the nearest foot of a sample on its patch: samples themselves are off by
/// their noise, and the nearest of them may be beyond an edge. Where the nearest curve of that patch is no farther than
/// that foot and 2 s beside, psi is the maximum of the functions of its two patches if the curve is convex, else the
/// minimum. Near a corner, in the same way, psi is given by its table of signs (corner_table.h).
///
/// Curves are the common zero sets of their patches.
/// @param points  of the cloud; `patches` contains the normals
/// @return none if no border is sharp
/// \throw std::invalid_argument as fit_patches(); Cancelled
std::optional<CloudDomain> cloud_domain(const std::vector<Vec3>& points, const SamplePatches& patches,
                                        const Context& context = {});

}  // namespace umtet
