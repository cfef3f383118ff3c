#pragma once

#include <array>
#include <vector>

#include "mesh/base/id_set.h"
#include "mesh/octree/octree_tets.h"

namespace umtet {

/// Vertices that are not where the octree has them, and by how much, in units of the octree's grid.
struct VertexOffsets {
  IdSet moved{0};
  std::vector<std::array<float, 3>> by;  ///< of the moved ones, ascending

  bool has(std::int64_t vertex) const { return !by.empty() && moved.test(vertex); }
};

/// Moves the corners of tets between two sizes so that the worst of them get better: from Q = .756 to .782, and to .778
/// where levels are at random. Vertices on the background boundary stay, and tets there may get worse: .740.
///
/// Every sweep takes a step of all these vertices at once towards the least sum of Q^-p over their rings: with
/// l_k = grad log Q(K_k) at the vertex and weights w_k = Q(K_k)^-p,
///
///     s_i = omega / p (A + lambda tr(A) I)^-1 sum w_k l_k,   A = sum w_k l_k l_k^T,
///     d_i <- mu d_i + s_i,   x_i <- x_i + d_i
///
/// p^2 A is what is left of the Hessian where p is great (Gauss-Newton), omega < 1 because the other corners of a tet
/// move too, mu is momentum [Polyak1964]. p grows from sweep to sweep, so that the last ones are about the worst tets
/// alone. A vertex depends on what is within as many edges as there are sweeps, in an order that no thread changes: far
/// from a change of the grading vertices stay where they are, bit by bit.
///
/// @param mesh    as the octree has it
/// @param moving  the vertices that may move
VertexOffsets smooth_transitions(const OctreeTets& mesh, IdSet moving, int n_sweeps);

}  // namespace umtet
