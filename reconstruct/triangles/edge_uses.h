#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// A side of a triangle.
struct EdgeUse {
  int low, high;  ///< its ends, low < high
  std::uint32_t face;
  bool forward;  ///< the triangle runs from low to high
};

/// Returns the sides of all triangles, sorted by edge, then by triangle. Triangles that welding collapses are left out.
/// @param corner  for each vertex the vertex that it is welded to, see welded()
std::vector<EdgeUse> edge_uses(const TriangleMesh& mesh, const std::vector<int>& corner);

/// Calls f(first, last) for every edge: the uses [first, last) belong to it.
template <class F>
void for_each_edge(const std::vector<EdgeUse>& uses, F f) {
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    while (last < uses.size() && uses[last].low == uses[first].low && uses[last].high == uses[first].high) ++last;
    f(first, last);
  }
}

}  // namespace umtet
