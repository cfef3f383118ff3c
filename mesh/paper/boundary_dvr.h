#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh/core/implicit_function.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/paper/dvr.h"

namespace umtet {

/// Parameters of boundary_dvr().
struct BoundaryDvrParams {
  int samples = 20;        ///< N_S: 2 N_S + 1 candidates in [-h, h], eq. (7); >= 1
  double h = 0;            ///< half-width of the samples, > 0, model units
  std::uint64_t seed = 0;  ///< tangents are a function of (seed, iteration, background vertex)
  ClosestPointParams closest_point;
};

/// Directional vertex relaxation of boundary vertices: one iteration of Algorithm 3. In ascending order, every vertex
/// is offered the positions pi(V_i + lambda d_i) for lambda = -h, -h + h / N_S, ..., h along a tangent d_i that turns
/// from iteration to iteration. It takes the best one if the worst quality of its ring rises.
///
/// lambda = 0 is the vertex's position, so its sample is the present quality. A position whose projection does not
/// converge is no candidate; among equals the first counts.
/// @return number of evaluations of psi
/// \pre every vertex is on {psi = 0}, and every tet at it has Q > 0
std::size_t boundary_dvr(MovingMesh& mesh, const RelaxationOrder& boundary,
                         std::span<const std::int64_t> background_vertex, ImplicitFunctionRef psi,
                         const BoundaryDvrParams& params, int iteration);

}  // namespace umtet
