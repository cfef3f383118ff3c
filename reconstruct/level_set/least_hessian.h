#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Values between bounds at the nodes of a grid, the first axis fastest.
struct BoundedValues {
  Eigen::Vector3i n = Eigen::Vector3i::Zero();
  std::vector<float> value;           ///< in: where the search starts; out: the minimiser
  std::vector<float> low, high;       ///< low <= high; only those of free nodes are read
  std::vector<std::uint8_t> is_free;  ///< 1: may change. None of the two outermost layers of nodes
};

/// How far the search goes.
struct LeastHessianParams {
  int max_iterations = 300;
  /// Waves of 2 pi / pull^(1/4) steps and longer stay as they were at the start.
  double pull = 0;
  /// The search ends where no value has changed by more than this in an iteration, in units of the values.
  double tolerance = 1e-4;
};

/// Minimises the Hessian energy of the grid under bounds,
///
///     min  1/2 sum_nodes |H u|^2 + pull (u - u0)^2,   low <= u <= high,   H u the second differences, mixed ones
///     included,
///
/// u0 the values that the search starts from. On a grid the gradient of the first term is L L u, L the Laplacian of
/// seven points: the squares of the six second differences sum up to it. Accelerated projected gradient with restarts
/// [BeckTeboulle2009; ODonoghueCandes2015]: iterates are always within the bounds, and an iteration reads each free
/// node twice. Waves of some ten nodes and less, such as the stairs of a mask, are gone after a few hundred iterations.
/// @param weights  of the second differences along each axis, 1 / step^2 in any unit
/// @return the number of iterations. The result does not depend on the number of threads.
int minimise_hessian(BoundedValues& u, const Vec3& weights, const LeastHessianParams& params = {});

}  // namespace umtet
