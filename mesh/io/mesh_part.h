#pragma once

#include <cstddef>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// Extracts some tets of a mesh with their vertices and all data of both, in their order in the mesh.
/// @param tets  ascending, indices into whole.mesh.C
/// \pre !whole.quadratic
MeshFile part_of(const MeshFile& whole, const std::vector<std::size_t>& tets);

}  // namespace umtet
