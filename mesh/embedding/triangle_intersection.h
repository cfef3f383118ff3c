#pragma once

#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Exact sign of the orientation of a, b, c projected along coordinate `axis`: +1 if counter-clockwise with the next
/// two axes as x and y.
int projected_orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// Tests whether two triangles, as closed sets, intersect outside of the vertices and the edge that they share by
/// index. Exact, without tolerance, also for coplanar triangles.
/// \pre neither is degenerate (with collinear corners), and they do not have the same three vertices
/// Cost: two orientation signs for most pairs that are not close.
bool meet_beyond_shared(const std::vector<Vec3>& V, const Triangle& f, const Triangle& g);

}  // namespace umtet
