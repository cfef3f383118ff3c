#pragma once

#include <functional>

#include "common/vec3.h"

namespace umtet {

/// True only where psi has no zero within some distance of x along every axis. Thread-safe.
using FarFromZero = std::function<bool(const Vec3& x)>;

/// Where the sign of psi is that of any other place within reach.
struct KnownSigns {
  FarFromZero far = {};  ///< to `reach`; empty: nothing is known
  double reach = 0;      ///< model units
};

}  // namespace umtet
