#pragma once

#include <memory>
#include <string>
#include <utility>

#include "body/edges/edged_cloud.h"
#include "body/given_triangles.h"
#include "body/piecewise_body.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"

namespace umtet {

/// Triangles with sharp edges and the functions of their patches.
struct EdgedTriangles {
  std::shared_ptr<const GivenTriangles> triangles;  ///< working coordinates
  std::shared_ptr<const PiecewiseBody> body;        ///< working coordinates; null if there is no sharp edge to keep
  Vec3 shift = Vec3::Zero();                        ///< origin of the working coordinates, model coordinates
};

/// Sets reconstruct.edges to given for a file of edges, unless the user sets it.
void take_given_edges(Parameters& parameters);

/// Finds the sharp edges of triangles. \param mesh  model coordinates
EdgedTriangles edged_triangles(TriangleMesh mesh, const Vec3& shift, const Parameters& parameters);

/// Finds the sharp edges of a cloud that the cloud stage has prepared. \param near  as edged_cloud()
EdgedCloud edged_cloud(const OrientedPointCloud& cloud, NeighbourDistances near, const CasePaths& paths,
                       const Context& context);

/// Returns the number of curves, corners and patches, and of the curves that angles do not show.
std::string edges_text(const SharpEdges& edges);

/// Returns whether the level-set stage kept the sharp edges of triangles or of a cloud instead of a fit.
bool has_edges(const StageRecord& level_set);

/// File name of the curves in the folder of the level-set stage.
inline constexpr const char* kFeatureFile = "features.vtp";
/// File name of the samples of a cloud with the patch of each, in the same folder.
inline constexpr const char* kPatchFile = "patches.vtp";

}  // namespace umtet
