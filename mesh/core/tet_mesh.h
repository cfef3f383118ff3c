#pragma once

#include <array>
#include <vector>

#include "common/vec3.h"

namespace umtet {

using Tet = std::array<int, 4>;       ///< vertex indices, positively oriented: det(v1 - v0, v2 - v0, v3 - v0) > 0
using Triangle = std::array<int, 3>;  ///< vertex indices, counter-clockwise seen from outside

/// Tet mesh T = (V, I, C) of the paper; the index set I is 0 .. V.size() - 1.
struct TetMesh {
  std::vector<Vec3> V;  ///< vertex coordinates, model units
  std::vector<Tet> C;   ///< connectivity
};

/// Vertices of the face opposite to local vertex k of a tet, counter-clockwise seen from outside the tet.
inline constexpr std::array<std::array<int, 3>, 4> kTetFace = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

}  // namespace umtet
