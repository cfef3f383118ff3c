#pragma once

#include <array>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Vertex indices of a 10-node tet in the order of VTK_QUADRATIC_TETRA: the four corners, oriented as in a Tet, then
/// the mid-sides of the edges 01 12 20 03 13 23. (TET10 of Abaqus and CalculiX has the same order; Gmsh's element 11
/// swaps the last two.)
using QuadraticTet = std::array<int, 10>;

/// The two corners between which local node 4 + k of a QuadraticTet lies.
inline constexpr std::array<std::array<int, 2>, 6> kMidSideEdge = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// Ten-node tet mesh. With barycentric coordinates l_0 .. l_3, an element is the image of the unit tet under
///
///     x(l) = sum_a l_a (2 l_a - 1) V[C[a]] + sum_k 4 l_p l_q V[C[4 + k]],   {p, q} = kMidSideEdge[k]
///
/// Tets with a common edge share its mid-side, so elements fit together without gaps. Corners come before mid-sides: in
/// a mesh made from a TetMesh, the first vertices are those of the TetMesh, with their indices.
struct QuadraticTetMesh {
  std::vector<Vec3> V;          ///< corners, then mid-sides; model units
  std::vector<QuadraticTet> C;  ///< connectivity
};

/// The nodes of a six-node boundary triangle, counter-clockwise seen from outside: three corners, then the mid-sides of
/// the edges 01 12 20. This is the order of VTK_QUADRATIC_TRIANGLE and of Gmsh's element 9.
using QuadraticTriangle = std::array<int, 6>;

}  // namespace umtet
