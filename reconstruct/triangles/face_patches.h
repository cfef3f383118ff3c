#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Patches of triangles connected through edges of two triangles each, which therefore have a common orientation.
struct FacePatches {
  std::vector<std::uint32_t> patch;  ///< patch of each triangle, from 0
  /// For each triangle, whether its orientation is opposite to most of the area of its patch.
  std::vector<std::uint8_t> is_turned;
  /// For each patch, whether each edge has the same number of triangles in both directions.
  std::vector<std::uint8_t> is_closed;
  std::size_t n_open_edges = 0;       ///< edges of one triangle
  std::size_t n_branching_edges = 0;  ///< edges of three and more triangles
  std::size_t n_one_sided_edges = 0;  ///< edges where orientations contradict each other, as on a Moebius strip
  double weld_distance = 0;           ///< corners closer than this are identified; model units

  std::size_t size() const { return is_closed.size(); }
};

/// Finds the patches of a mesh. Corners are identified (welded) if they are at one position, or closer than a tolerance
/// if that joins more edges: the least of a few tolerances, up to a thousandth of the diagonal and a quarter of the
/// median edge. Positions do not change; welding determines neighbours only.
/// \pre every triangle has an area. Cost: O(n log n)
FacePatches find_patches(const TriangleMesh& mesh);

/// For each vertex the first vertex at its position or, with a tolerance > 0, within the tolerance of a vertex that was
/// kept.
std::vector<int> welded(const std::vector<Vec3>& V, double tolerance);

/// Drops triangles without an area, and all but the first of those with the same three corners (by position, in any
/// order). @return the number of each
struct DroppedFaces {
  std::size_t n_degenerate = 0, n_duplicates = 0;
};
DroppedFaces drop_useless_faces(TriangleMesh& mesh);

/// Reverses the orientation of a triangle.
void turn_face(TriangleMesh& mesh, std::size_t f);

/// Diagonal of the bounding box of the vertices used by triangles.
double diagonal_of(const TriangleMesh& mesh);

}  // namespace umtet
