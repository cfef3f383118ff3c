#pragma once

#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// Variant of linked_active_layer() for an omega_h that may reach the background boundary, whose vertices are walls and
/// do not move. It uses stars and links instead of tables of bit masks, and a greedy colouring of the layer's own
/// vertices in ascending order. Vertices, roles and tets are the same. Cost: linear in the stars of the inside
/// vertices, about ten times the cost of linked_active_layer().
/// @param inside  its vertices on the background boundary do not move
BackgroundLayer walled_active_layer(const BackgroundMesh& background, const IdSet& inside, int layers = 2);

}  // namespace umtet
