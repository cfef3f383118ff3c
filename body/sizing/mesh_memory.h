#pragma once

#include "mesh/background/background_mesh.h"

namespace umtet {

/// Checks before a mesh is made that there is enough memory for it.
/// @param n_tets   approximate number of tets of the mesh
/// @param allowed  bytes of memory that the mesh may use
/// \throw ResourceLimit  with the estimate, if it exceeds `allowed`
void require_memory(const BackgroundMesh& background, double n_tets, double allowed);

}  // namespace umtet
