#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/octree/octree_grid.h"

namespace umtet {

/// A position in a cube in units of half its width, 0 to 2 along each axis.
using CubeCode = std::array<int, 3>;
constexpr int code_index(const CubeCode& c) { return c[0] + 3 * (c[1] + 3 * c[2]); }

/// A leaf, or a vertex whose position is not in any leaf.
struct OctreeCell {
  static constexpr std::uint8_t kPoint = 0xff;

  std::array<std::int32_t, 6> neighbor = {-1, -1, -1, -1, -1, -1};  ///< see LinearOctree
  std::uint32_t first_vertex = 0;
  std::uint8_t level = kPoint;
  std::uint8_t vertices = 1;  ///< bit x + 2 y + 4 z: there is a vertex at (x, y, z) half widths from the lower corner
  std::uint8_t coarse = 0;    ///< bit per face: the leaf behind it is twice as wide
  std::uint8_t octant = 0;    ///< x + 2 y + 4 z, position in the parent
  std::uint64_t slots = 0;    ///< bit per possible tet: tet_slots.h
  std::int64_t first_tet = 0;

  bool is_leaf() const { return level != kPoint; }
};

/// The leaves of a balanced octree in Morton order [Burstedde2011] with their neighbours, and the vertices of a mesh on
/// them: corners and centres of leaves, and centres of faces without a leaf behind.
///
/// A vertex belongs to the half-open cube that contains it. The vertices of a leaf are therefore its lower corner, its
/// centre, and those of its lower edge mid-points and face centres that are corners of finer leaves. The few vertices
/// that lie in no leaf (at upper walls) are separate cells. Vertices are in Morton order if cells are, and none is
/// stored.
///
/// Face 2 a is the lower one along axis a, 2 a + 1 the upper. The neighbour behind a face is the leaf of the same or of
/// twice the size, or, of four leaves of half the size, the one with the least coordinates, or none (-1).
class LinearOctree {
 public:
  /// @param cubes  sorted cube_key()s of a balanced octree
  explicit LinearOctree(const std::vector<std::uint64_t>& cubes);

  int n_cells() const { return static_cast<int>(cells_.size()); }
  const OctreeCell& cell(int c) const { return cells_[static_cast<std::size_t>(c)]; }
  OctreeCell& cell(int c) { return cells_[static_cast<std::size_t>(c)]; }
  /// Key of the lower corner of a leaf, or of the point.
  std::uint64_t corner_key(int c) const { return keys_[static_cast<std::size_t>(c)]; }
  std::int64_t n_vertices() const { return n_vertices_; }
  /// The leaf or point whose half-open cube contains this key, or -1.
  int locate(std::uint64_t key) const { return locate(key, 0, keys_.size()); }
  int locate(const GridPoint& p) const { return is_in_root(p) ? locate(morton_key(p)) : -1; }
  /// The same for a position near a cell; goes across faces, and searches only where these lead to no leaf.
  int locate_from(int c, const GridPoint& p) const;
  /// Grid point of a position in a leaf.
  GridPoint point(int leaf, const CubeCode& code) const;
  /// A vertex as cell and bit in OctreeCell::vertices; {-1, 0} if there is no vertex.
  struct VertexPlace {
    int cell, bit;
  };
  VertexPlace place(std::uint64_t key) const { return place_in(locate(key), key); }
  VertexPlace place(int leaf, const CubeCode& code) const;
  /// True if the mid-point of the edge between two faces of a leaf is a vertex.
  bool is_edge_split(int leaf, int face, int other_face) const;
  /// Of the four leaves behind a face, the one at the given sides of the other two axes (a + 1, a + 2 modulo 3).
  int small_leaf(int leaf, int face, bool upper_u, bool upper_v) const;

 private:
  VertexPlace place_in(int c, std::uint64_t key) const;
  int equal_leaf(int leaf, const CubeCode& code) const;
  int locate(std::uint64_t key, std::size_t begin, std::size_t end) const;
  int locate_near(std::size_t c, std::uint64_t key) const;
  std::uint64_t end_key(int c) const;
  void find_neighbors();
  void find_points(int leaf, std::vector<std::uint64_t>& points) const;
  void add_points();
  void find_vertices();

  std::vector<std::uint64_t> keys_;
  std::vector<OctreeCell> cells_;
  std::int64_t n_vertices_ = 0;
};

}  // namespace umtet
