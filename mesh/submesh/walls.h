#pragma once

#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// The faces of omega_h on the background boundary, local vertex ids, outward; ascending in (tet, local face).
std::vector<Triangle> wall_faces(const BackgroundMesh& background, const Submesh& submesh);

/// Positive vertices within two edges of a vertex of omega_h on the background boundary. There psi = 0 and a wall would
/// share a layer of two layers, or a face. count == 0: there are none.
UmEvidence boundary_near_walls(const BackgroundMesh& background, const Submesh& submesh);

}  // namespace umtet
