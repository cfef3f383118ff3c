#pragma once

#include "mesh/background_mesh.h"
#include "pipeline/parameters.h"

namespace umtet {

/// Bytes that a stage may take: output.max_memory, or what the system says it can give.
double allowed_bytes(const Parameters& parameters);

/// To call before a mesh is made: is there memory for it?
/// @param n_tets  about how many tets it will have
/// \throw ResourceLimit with the estimate, when it is more than `allowed`
void require_memory(const BackgroundMesh& background, double n_tets, double allowed);

}  // namespace umtet
