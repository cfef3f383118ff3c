#pragma once

#include <cstddef>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Removes triangles that are lower than a tolerance, whose normals are rounding. A triangle with a side shorter than
/// the tolerance collapses into an edge. In any other, a corner lies on the opposite side: that side is flipped, and
/// the corner becomes one of the neighbour. The surface moves by no more than the tolerance, and its topology stays.
///
/// A line along the side that is flipped becomes the two lines beside it, and the sliver takes the label of its
/// neighbour. Vertices at one position become one vertex. Triangles at edges of one, three and more triangles stay as
/// they are.
/// @param tolerance  model units
/// @return the number of triangles that collapsed or were flipped
std::size_t remove_slivers(TriangleMesh& mesh, double tolerance);

}  // namespace umtet
