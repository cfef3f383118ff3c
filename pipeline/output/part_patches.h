#pragma once

#include <string>
#include <vector>

#include "pipeline/case/parameters.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/output/boundary_patches.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Calls divide_boundary() for a distributed mesh, with its boundary alone, and collects the data of its vertices.
/// @param cloud    the cloud from which the mesh was made, or an empty cloud
/// @param support  support of the certificate of the mesh
/// \throw UsageError  the exceptions of divide_boundary()
PieceData piece_data(const MeshWithBoundary& mesh, const OrientedPointCloud& cloud,
                     const std::optional<SupportReport>& support, const Parameters& parameters, const Warn& warn,
                     const std::vector<std::string>& names_of_file);

}  // namespace umtet
