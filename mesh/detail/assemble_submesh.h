#pragma once

#include <cstdint>
#include <vector>

#include "mesh/background_mesh.h"
#include "mesh/detail/id_set.h"
#include "mesh/submesh.h"

namespace umtet::detail {

/// Algorithm 1, steps 14-22, once it is known which tets are in omega_h and which of their vertices are inside.
/// Both searches end here, so that equal sets give equal bytes.
/// @param tets  background ids, ascending
Submesh assemble_submesh(const BackgroundMesh& background, std::vector<std::int64_t> tets, const IdSet& inside);

}  // namespace umtet::detail
