#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh/core/implicit_function.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/paper/dvr.h"

namespace umtet {

struct BoundaryDvrParams {
  int samples = 20;        ///< N_S: 2 N_S + 1 candidates in [-h, h], eq. (7); >= 1
  double h = 0;            ///< half-width of the samples, > 0, model units
  std::uint64_t seed = 0;  ///< tangents are a function of (seed, iteration, background vertex)
  ClosestPointParams closest_point;
};

/// One iteration of Algorithm 3: every vertex in ascending order is offered the places pi(V_i + lambda d_i) for
/// lambda = -h, -h + h / N_S, ..., h along a tangent d_i that turns from iteration to iteration, and takes the best if
/// the worst quality of its ring rises. lambda = 0 is where the vertex is, so its sample is the quality it has. A place
/// whose projection does not settle is no candidate; among equals the first counts.
/// @return evaluations of psi
/// \pre every vertex lies on {psi = 0}, every tet at it has Q > 0
std::size_t boundary_dvr(MovingMesh& mesh, const RelaxationOrder& boundary,
                         std::span<const std::int64_t> background_vertex, ImplicitFunctionRef psi,
                         const BoundaryDvrParams& params, int iteration);

}  // namespace umtet
