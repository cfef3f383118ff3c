#pragma once

#include <functional>

#include "common/vec3.h"

namespace umtet {

/// Returns true only if psi has no zero within some distance of x along every axis. Thread-safe.
using FarFromZero = std::function<bool(const Vec3& x)>;

/// Regions in which psi is known not to change sign.
struct KnownSigns {
  FarFromZero far = {};  ///< whether psi has no zero within the distance `reach`; empty if this is unknown
  double reach = 0;      ///< model units
};

}  // namespace umtet
