#pragma once

#include <string>
#include <vector>

#include "pipeline/case/parameters.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/output/boundary_patches.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// divide_boundary() of a mesh that several processes have, by its boundary alone, and what its vertices carry.
/// @param cloud    that the mesh was made of, or none
/// @param support  of the certificate of the mesh
/// \throw UsageError  as divide_boundary()
PieceData piece_data(const MeshWithBoundary& mesh, const OrientedPointCloud& cloud,
                     const std::optional<SupportReport>& support, const Parameters& parameters, const Warn& warn,
                     const std::vector<std::string>& names_of_file);

}  // namespace umtet
