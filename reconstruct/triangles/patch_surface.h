#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reconstruct/triangles/sharp_edges.h"
#include "reconstruct/triangles/triangle_mesh.h"
#include "reconstruct/triangles/triangle_tree.h"

namespace umtet {

/// A smooth patch of a triangulated surface as the zero set of a function.
///
/// At x, with the closest point y of the patch and the normal n at y, interpolated between the normals of the corners
/// [Phong1975]:
///
///     f(x) = |x - y| sign((x - y) . n)   where y is inside of the patch,
///     f(x) = (x - y) . n                 where y is on its border
///
/// So the patch is the zero set, and beyond its border goes on straight. The gradient is the direction in which f grows
/// fastest, (x - y) / f or n; at the patch it is n, so that it turns smoothly from triangle to triangle. f has no
/// second derivatives. Immutable; thread-safe.
class PatchSurface {
 public:
  /// @param mesh   triangles of the patch, outward; vertices at one position are identified
  explicit PatchSurface(TriangleMesh mesh);

  /// f(x); the gradient, of unit length, is written to a pointer that is not null.
  double evaluate(const Vec3& x, Vec3* gradient) const;

 private:
  TriangleMesh mesh_;
  TriangleTree tree_;
  std::vector<Vec3> normal_;                            ///< normals of vertices
  std::vector<std::array<std::uint8_t, 3>> is_border_;  ///< per triangle: its side from corner k to k + 1
  std::vector<std::uint8_t> is_on_border_;              ///< per vertex
};

/// The triangles of each patch, by number of the patch. Vertices of no triangle are left out.
std::vector<TriangleMesh> split_patches(const TriangleMesh& mesh, const SharpEdges& edges);

}  // namespace umtet
