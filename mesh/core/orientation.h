#pragma once

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Orientation of a tet: the exact sign of det(b - a, c - a, d - a). +1 positively oriented, -1 inverted, 0 flat.
///
/// A floating-point filter with a proven error bound decides nearly all calls. The others are decided in integer
/// arithmetic, because doubles are integers times powers of two.
/// @return 0 also if a coordinate is not finite: such a tet has no volume that could be called positive.
/// Cost: 40 flops when the filter decides, some microseconds otherwise. Thread-safe.
int orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Bounds of the filter: |det| > kFilterBound * permanent decides if the permanent (the determinant of absolute values)
/// is greater than kFilterLeast and every difference of coordinates is below kFilterGreatest.
inline constexpr double kFilterBound = 0x1p-50, kFilterLeast = 1e-200, kFilterGreatest = 1e100;

}  // namespace umtet
