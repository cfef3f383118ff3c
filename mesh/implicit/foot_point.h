#pragma once

#include <limits>

#include "mesh/core/implicit_function.h"

namespace umtet {

/// Foot point: a point of psi = 0 near x.
struct Foot {
  bool found = false;
  double distance = std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< grad psi / |grad psi| at the foot point
};

/// Closest point of psi = 0 to x, by alternating a step along the surface towards the foot of x and a return to the
/// surface.
///
/// Only steps that reduce the distance are taken, so the result is never below the true distance nor above the distance
/// of the first point found. The code is deliberately separate from the mesher's projection: a certificate must not
/// share its errors.
/// @param h  edge length; no step is longer than half of it
Foot foot_point(ImplicitFunctionRef psi, const Vec3& x, double h);

}  // namespace umtet
