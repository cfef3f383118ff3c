#pragma once

#include "common/vec3.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Rounds the vertices to the values that a file stores, in working coordinates: a file stores x + shift, rounded, and
/// the subtraction of the shift is exact (far_origin_shift). All later measurements are of these rounded vertices.
void round_to_file(UmResult& result, const Vec3& shift);

}  // namespace umtet
