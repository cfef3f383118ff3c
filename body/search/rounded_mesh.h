#pragma once

#include "common/vec3.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Makes the vertices those that a file will hold, in working coordinates: it stores x + shift, rounded, and taking the
/// shift off again is exact (far_origin_shift). From here on that is the mesh: it is this one that is measured.
void round_to_file(UmResult& result, const Vec3& shift);

}  // namespace umtet
