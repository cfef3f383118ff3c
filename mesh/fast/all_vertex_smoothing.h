#pragma once

#include <cstddef>

#include "mesh/core/implicit_function.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

struct AllVertexReport {
  double least = 0;     ///< mean ratio of the worst tet with a vertex that moves; 0 where the layer stayed as it was
  int evaluations = 0;  ///< of the norm
  std::size_t psi_evaluations = 0;  ///< of psi and its gradient
};

/// Raises the least mean ratio of a small layer by moving all its vertices at once.
///
///   min over x of  phi_p(x) = ln ||1/Q(x)||_p = (1/p) ln sum_K Q_K(x)^-p,   p = 96, 384, 1536, one after the other:
///   ln (1 / min Q) <= phi_p <= ln (1 / min Q) + (ln n) / p for n tets
///
/// PNormSmoother solves one vertex at a time, and stops where the worst tets can only be raised by two or more vertices
/// together [Diachin2006]. This goes on from there: L-BFGS [LiuNocedal1989] with backtracking, so that phi_p falls with
/// every step and no volume gets to zero. A Boundary vertex has its unknowns in its tangent plane, and its place is
/// where the line along its normal meets psi = 0, so the gradient is exact.
///
/// @param layer  small: a few hundred vertices; those that are not Fixed move. Receives the places with the greatest
///               least Q that were met, or stays as it is: where a tet is not positive, or a Boundary vertex does not
///               get to psi = 0
/// @param goal   mean ratio at which it stops; the first places that reach it will do
/// Cost: 40 ns a tet and evaluation, of which there are some 100 (`mesh_bench --benchmark_filter=all_vertices`). One
/// thread.
AllVertexReport smooth_all_vertices(ActiveLayer& layer, ImplicitFunctionRef psi, double goal);

}  // namespace umtet
