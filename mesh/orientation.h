#pragma once

#include "mesh/tet_mesh.h"

namespace umtet {

/// Exact sign of det(b - a, c - a, d - a): +1 positively oriented, -1 inverted, 0 flat.
///
/// A floating-point filter with a proven error bound decides nearly all calls; the rest is done in integers, because
/// doubles are integers times powers of two.
/// @return 0 also when a coordinate is not finite: such a tet has no volume that could be called positive.
/// Cost: 40 flops when the filter decides, some microseconds otherwise. Thread-safe.
int orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace umtet
