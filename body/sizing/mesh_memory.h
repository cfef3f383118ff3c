#pragma once

#include "mesh/background/background_mesh.h"

namespace umtet {

/// To call before a mesh is made: is there memory for it?
/// @param n_tets  about how many tets it will have
/// \throw ResourceLimit with the estimate, when it is more than `allowed`
void require_memory(const BackgroundMesh& background, double n_tets, double allowed);

}  // namespace umtet
