#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Values with bounds at the nodes of a grid, first axis fastest.
struct BoundedValues {
  Eigen::Vector3i n = Eigen::Vector3i::Zero();
  std::vector<float> value;           ///< in: initial values; out: the minimiser
  std::vector<float> low, high;       ///< low <= high; read at free nodes only
  std::vector<std::uint8_t> is_free;  ///< 1: may change. Nodes of the two outermost layers are not free
};

/// Parameters of minimise_hessian().
struct LeastHessianParams {
  int max_iterations = 300;
  /// Waves with a length of 2 pi / pull^(1/4) steps or more keep their initial values.
  double pull = 0;
  /// The iteration stops when no value changes by more than this in an iteration, in units of the values.
  double tolerance = 1e-4;
};

/// Minimises the Hessian energy of a grid function under bounds,
///
///     min  1/2 sum_nodes |H u|^2 + pull (u - u0)^2,   low <= u <= high,   H u the second differences, mixed ones
///     included,
///
/// with u0 the initial values. On a grid the gradient of the first term is L L u, with L the seven-point Laplacian,
/// because the squares of the six second differences sum to it. The method is an accelerated projected gradient method
/// with restarts [BeckTeboulle2009; ODonoghueCandes2015]. Iterates always satisfy the bounds, and an iteration reads
/// each free node twice. Waves of about ten nodes and less, such as the stairs of a mask, vanish within a few hundred
/// iterations.
/// @param weights  weights of the second differences along each axis, 1 / step^2 in any unit
/// @return the number of iterations. The result does not depend on the number of threads.
int minimise_hessian(BoundedValues& u, const Vec3& weights, const LeastHessianParams& params = {});

}  // namespace umtet
