#pragma once

#include <cstddef>

#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

/// Reclassifies vertices until no positive face has positively cut tets on both sides. That happens where what is
/// outside is thinner than an edge: at the tip of a body in a fluid. Of the five vertices of such a pair of tets the
/// one nearest to psi = 0 is flipped, each vertex once at most. What is left when that does not help any more is in
/// double_positive_faces().
/// @param submesh  emit_submesh() of `inside`, on entry and on return
/// @return number of vertices flipped
std::size_t part_double_faces(const BackgroundMesh& background, ImplicitFunctionRef psi, IdSet& inside,
                              Submesh& submesh);

}  // namespace umtet
