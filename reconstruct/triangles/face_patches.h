#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Triangles that hang together through edges of two triangles each, and so have one side.
struct FacePatches {
  std::vector<std::uint32_t> patch;     ///< by triangle: its patch, from 0 on
  std::vector<std::uint8_t> is_turned;  ///< by triangle: it looks to the other side than most of its patch, by area
  std::vector<std::uint8_t> is_closed;  ///< by patch: as many triangles end at each of its edges as begin
  std::size_t n_open_edges = 0;         ///< of one triangle
  std::size_t n_branching_edges = 0;    ///< of three and more
  std::size_t n_one_sided_edges = 0;    ///< where sides contradict each other, as on a Moebius strip
  double weld_distance = 0;             ///< corners that are nearer are one; model units

  std::size_t size() const { return is_closed.size(); }
};

/// Corners are one where they are at one place, or nearer than a tolerance if that joins more edges: the least of a few
/// tolerances, up to a thousandth of the diagonal and a quarter of the median edge. Places stay as they are: welding
/// tells neighbours, nothing else.
/// \pre every triangle has an area. Cost: O(n log n)
FacePatches find_patches(const TriangleMesh& mesh);

/// For each vertex the first one that is at its place or, with a tolerance > 0, within it of one that has stayed.
std::vector<int> welded(const std::vector<Vec3>& V, double tolerance);

/// Drops triangles without an area, and all but the first of those with the same three corners (places, whatever their
/// order). @return how many of both
struct DroppedFaces {
  std::size_t n_degenerate = 0, n_duplicates = 0;
};
DroppedFaces drop_useless_faces(TriangleMesh& mesh);

/// Makes it look to the other side.
void turn_face(TriangleMesh& mesh, std::size_t f);

/// Diagonal of the box around the vertices that triangles use.
double diagonal_of(const TriangleMesh& mesh);

}  // namespace umtet
