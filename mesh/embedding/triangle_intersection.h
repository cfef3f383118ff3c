#pragma once

#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Exact sign of the orientation of a, b, c, their coordinate `axis` left out: +1 counter-clockwise where the next two
/// axes are x and y.
int projected_orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// Whether two triangles meet, as closed sets, elsewhere than in the vertices and the edge that they share by index.
/// Exact: no tolerance, also where they are in one plane.
/// \pre neither is degenerate (of collinear corners), and they are not the same three vertices
/// Cost: two orientation signs for most pairs that are not near.
bool meet_beyond_shared(const std::vector<Vec3>& V, const Triangle& f, const Triangle& g);

}  // namespace umtet
