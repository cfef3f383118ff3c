#pragma once

#include <array>
#include <vector>

#include "mesh/base/id_set.h"
#include "mesh/octree/octree_tets.h"

namespace umtet {

/// Displacements of vertices from their positions in the octree, in units of the octree's grid.
struct VertexOffsets {
  IdSet moved{0};
  std::vector<std::array<float, 3>> by;  ///< displacements of the moved vertices, ascending by vertex

  bool has(std::int64_t vertex) const { return !by.empty() && moved.test(vertex); }
};

/// Smoothing of the transitions of a graded mesh: moves the corners of tets between two sizes to improve the worst of
/// them. Q rises from .756 to .782, and to .778 for random levels. Vertices on the background boundary do not move, and
/// tets there may get worse: .740.
///
/// Every sweep moves all these vertices at once by a step that reduces the sum of Q^-p over their rings. With l_k =
/// grad log Q(K_k) at the vertex and weights w_k = Q(K_k)^-p,
///
///     s_i = omega / p (A + lambda tr(A) I)^-1 sum w_k l_k,   A = sum w_k l_k l_k^T,
///     d_i <- mu d_i + s_i,   x_i <- x_i + d_i
///
/// p^2 A is the Hessian's dominant part for large p (Gauss-Newton), omega < 1 because the other corners of a tet move
/// too, and mu is momentum [Polyak1964]. p grows from sweep to sweep, so that the last sweeps affect only the worst
/// tets. A vertex depends on the vertices within as many edges as there are sweeps, in an order that does not depend on
/// threads. Far from a change of the grading, vertices therefore stay the same bit by bit.
///
/// @param mesh    mesh with vertices at their positions in the octree
/// @param moving  the vertices that may move
VertexOffsets smooth_transitions(const OctreeTets& mesh, IdSet moving, int n_sweeps);

}  // namespace umtet
