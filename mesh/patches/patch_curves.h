#pragma once

#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/patches/named_part.h"

namespace umtet {

/// The edges between boundary faces F of two patches, as curves curve_1, curve_2 ... that end where more than two
/// patches meet. Their order is that of the patches, then of the vertices.
/// @param face_patch  patch of each face
std::vector<MeshCurve> curves_between(const std::vector<Triangle>& F, const std::vector<int>& face_patch);

}  // namespace umtet
