#pragma once

#include <cstddef>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// Some tets of a mesh with their vertices and all data of both, in the order that they have there.
/// @param tets  ascending, indices into whole.mesh.C \pre !whole.quadratic
MeshFile part_of(const MeshFile& whole, const std::vector<std::size_t>& tets);

}  // namespace umtet
