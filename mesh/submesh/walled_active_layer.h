#pragma once

#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// The layer of linked_active_layer() where omega_h may reach the background boundary, whose vertices are walls and do
/// not move: through stars and links instead of tables of bit masks, with a greedy colouring of the layer's own
/// vertices in ascending order. The same vertices, roles and tets. Cost: linear in the stars of the inside vertices,
/// some ten times that of linked_active_layer().
/// @param inside  its vertices on the background boundary stay where they are
BackgroundLayer walled_active_layer(const BackgroundMesh& background, const IdSet& inside, int layers = 2);

}  // namespace umtet
