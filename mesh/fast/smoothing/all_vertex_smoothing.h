#pragma once

#include <cstddef>

#include "mesh/core/implicit_function.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// Report of smooth_all_vertices().
struct AllVertexReport {
  double least = 0;     ///< mean ratio of the worst tet with a vertex that moves; 0 if the layer did not change
  int evaluations = 0;  ///< evaluations of the norm
  std::size_t psi_evaluations = 0;  ///< evaluations of psi and its gradient
};

/// Smoothing of all vertices of a small layer at once, which raises its least mean ratio.
///
///   min over x of  phi_p(x) = ln ||1/Q(x)||_p = (1/p) ln sum_K Q_K(x)^-p,   p = 96, 384, 1536, one after the other:
///   ln (1 / min Q) <= phi_p <= ln (1 / min Q) + (ln n) / p for n tets
///
/// PNormSmoother solves for one vertex at a time. It stops where only two or more vertices together can raise the worst
/// tets [Diachin2006]; this function continues from there. It uses L-BFGS [LiuNocedal1989] with backtracking, so that
/// phi_p falls with every step and no volume reaches zero. The unknowns of a Boundary vertex lie in its tangent plane,
/// and its position is the point where the line along its normal meets psi = 0. The gradient is therefore exact.
///
/// @param layer  a small layer of a few hundred vertices; the vertices that are not Fixed move. On return it has the
///               positions with the greatest least Q that were found. It stays unchanged if a tet is not positive or a
///               Boundary vertex does not reach psi = 0
/// @param goal   mean ratio at which the iteration stops, at the first positions that reach it
/// @param needed mean ratio: greater p are not tried where no positions near a minimum of phi_p reach this, by
///               min Q <= n^(1/p) exp(-phi_p)
/// @param least_gain  decrease of phi_p by a step below which the next p has its turn
/// Cost: 40 ns per tet and evaluation, with about 100 evaluations (`mesh_bench --benchmark_filter=all_vertices`). Runs
/// in one thread.
AllVertexReport smooth_all_vertices(ActiveLayer& layer, ImplicitFunctionRef psi, double goal, double needed = 0,
                                    double least_gain = 1e-5);

}  // namespace umtet
