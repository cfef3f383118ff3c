#pragma once

#include <vector>

#include "body/fidelity/mesh_measures.h"
#include "common/context.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// Returns the size at each point. \throw Cancelled
std::vector<double> asked_sizes(const SizeField& sizes, const std::vector<Vec3>& points, const Context& context = {});

/// Returns the mean length of the edges at each vertex; 0 for a vertex without edges.
std::vector<double> mean_edges(const std::vector<Vec3>& V, const std::vector<Tet>& C);

/// Compares the edges of a mesh with the required sizes.
/// @param boundary  boundary faces of the mesh
/// @param asked     required size at each vertex
/// \pre the mesh has a tet
SizesReport sizes_report(const TetMesh& mesh, const std::vector<Triangle>& boundary, const std::vector<double>& asked);

}  // namespace umtet
