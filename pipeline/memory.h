#pragma once

#include "mesh/background_mesh.h"

namespace umtet {

/// To call before a mesh is made: is there memory for it?
/// @param n_tets  about how many tets it will have
/// \throw ResourceLimit with the estimate, when it is more than this process can get
void require_memory(const BackgroundMesh& background, double n_tets);

}  // namespace umtet
