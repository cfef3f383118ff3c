#pragma once

#include <memory>
#include <optional>

#include "body/body.h"
#include "body/piecewise_body.h"
#include "common/context.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/patches/sample_patches.h"

namespace umtet {

/// A cloud with sharp edges and the functions of its smooth patches.
struct EdgedCloud {
  SamplePatches patches;                      ///< patches of the samples of the cloud
  std::shared_ptr<const PiecewiseBody> body;  ///< working coordinates; null if the cloud has no sharp edge
  Vec3 shift = Vec3::Zero();                  ///< origin of the working coordinates, model coordinates
};

/// Divides a cloud into smooth patches and finds the sharp edges between them (segment_cloud.h, cloud_domain.h).
///
/// The body is null, and the cloud has no sharp edge to keep, if all patches continue each other, if a curve breaks off
/// where two patches meet, or if no curve is found along the borders.
/// @param cloud   model coordinates, with outward normals
/// @param near    distances between neighbours of the cloud; empty: they are computed
/// @param has_measured_normals  false: the normals are estimates, and more evidence is necessary for an edge
/// \throw Cancelled
EdgedCloud edged_cloud(const OrientedPointCloud& cloud, NeighbourDistances near, bool has_measured_normals,
                       const Context& context = {});

/// The domain of such a cloud. psi is the function of the patches; there is no fitted level set.
/// \pre edged.body
/// @param cloud  the samples, model coordinates
/// @param box    the box to be meshed, model coordinates; empty: with_margin() of the box of the samples
/// @param h      edge length, if it is given, or 0
Domain edged_domain(const EdgedCloud& edged, OrientedPointCloud cloud, const std::optional<Box>& box, double h);

}  // namespace umtet
