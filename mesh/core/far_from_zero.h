#pragma once

#include <functional>

#include "common/vec3.h"

namespace umtet {

/// Returns true only if psi has no zero within some distance of x along every axis. Thread-safe.
using FarFromZero = std::function<bool(const Vec3& x)>;

/// Regions in which psi is known not to change sign.
struct KnownSigns {
  FarFromZero far = {};  ///< for the distance `reach`; empty: nothing is known
  double reach = 0;      ///< model units
};

}  // namespace umtet
