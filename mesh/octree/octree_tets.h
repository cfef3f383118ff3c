#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/base/id_set.h"
#include "mesh/octree/bcc_link.h"
#include "mesh/octree/linear_octree.h"

namespace umtet {

/// The tets on the leaves of an octree (tet_slots.h) and their adjacency, in grid coordinates.
///
/// Vertices and tets have dense ids in the order of the leaves. Neither are stored: they are computed from the leaves,
/// their neighbours, and the numbers of vertices and tets before each leaf. Immutable.
class OctreeTets {
 public:
  /// @param cubes  sorted cube_key()s of a balanced octree
  explicit OctreeTets(const std::vector<std::uint64_t>& cubes);

  std::int64_t n_vertices() const { return octree_.n_vertices(); }
  std::int64_t n_tets() const { return n_tets_; }
  std::int64_t n_leaves() const { return n_leaves_; }
  const GridPoint& lowest() const { return lowest_; }  ///< corner of the bounding box
  const GridPoint& highest() const { return highest_; }
  std::size_t n_bytes() const;  ///< memory used

  std::uint64_t key(std::int64_t vertex) const;
  std::int64_t vertex_of(std::uint64_t key) const;
  std::uint64_t tet_key(std::int64_t tet) const;
  std::array<std::int64_t, 4> tet(std::int64_t tet) const;
  void star(std::int64_t vertex, std::vector<std::int64_t>& tets) const;
  void link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const;
  /// The vertices of link(), by z, then y, then x of their positions relative to the vertex. Returns false and lists
  /// nothing if some tet at the vertex is not a BCC tet or has another size.
  bool bcc_link(std::int64_t vertex, BccLink& vertices) const;
  std::int64_t neighbor(std::int64_t tet, int face) const;
  bool on_boundary(std::int64_t vertex) const;
  /// These vertices and the vertices within `rings` edges of them.
  IdSet with_rings(const IdSet& vertices, int rings) const;
  /// Sorted keys of the leaves around these vertices and of their siblings. They form an octree with tets on all sides
  /// of each vertex. The tets differ from those of this octree only where the edge of a leaf is no longer split.
  std::vector<std::uint64_t> leaves_at(const IdSet& vertices) const;
  /// Mean length of the edges at a vertex.
  double mean_edge(std::int64_t vertex) const;
  /// Some tet at the centre of the leaf that contains a point, or -1.
  std::int64_t tet_near(const GridPoint& p) const;
  /// True if a tet is not a BCC tet: it lies between two sizes, or is a half.
  bool is_transition(std::int64_t tet) const;
  /// The corners of tets between two sizes.
  IdSet transition_vertices() const;
  class Reader;

 private:
  /// The leaves around a vertex that is not a centre, and the position of the vertex in them.
  struct Around {
    int n = 0;
    std::array<std::pair<int, int>, 8> leaves;  ///< leaves, each with its code_index()
    bool of_one_size = false;                   ///< eight leaves of one size, by octant
    bool is_complete = true;                    ///< no leaf is missing
  };
  /// Leaves around a vertex, with the bits of their slots: for a centre, its own leaf and 24 small leaves behind its
  /// faces.
  struct Star {
    int n = 0;
    std::array<std::pair<int, std::uint64_t>, 25> parts;
    void add(int leaf, std::uint64_t slots) {
      if (slots != 0) parts[static_cast<std::size_t>(n++)] = {leaf, slots};
    }
    void sort();
  };
  /// Neighbours with repetitions: for a centre, up to 33 of its own leaf and 5 of each of 24 small leaves; fewer for a
  /// point.
  using Link = std::array<std::int64_t, 192>;

  void find_slots(int leaf);
  int cell_of_vertex(std::int64_t vertex) const;
  int cell_of_tet(std::int64_t tet) const;
  bool is_centre(std::int64_t vertex) const;
  std::int64_t vertex_id(const LinearOctree::VertexPlace& place) const;
  std::int64_t centre_id(int leaf) const { return vertex_id({leaf, 7}); }
  std::int64_t tet_id(int leaf, int slot) const;
  std::array<std::int64_t, 4> corners(int leaf, int slot) const;
  /// @param vertex  maps each position in the leaf except its centre to a vertex
  template <class VertexAt>
  std::array<std::int64_t, 4> corners_among(int leaf, int slot, const VertexAt& vertex) const;
  std::int64_t tet_at_edge(int leaf, int face, int e, int half) const;
  std::int64_t tet_around_edge(int leaf, int face, int e, int half, bool split) const;
  Around around(std::int64_t vertex) const;
  Star star_of(std::int64_t vertex) const;
  void add_star_of_centre(int leaf, Star& star) const;
  void add_star_of_point(const Around& around, Star& star) const;
  std::uint64_t parent(int leaf) const;
  bool is_regular_centre(int leaf) const;
  bool is_regular_point(const Around& around) const;
  /// True if all tets at a vertex are BCC tets of one size.
  bool is_regular(std::int64_t vertex) const;
  int link_of(std::int64_t vertex, Link& link) const;

  LinearOctree octree_;
  std::int64_t n_leaves_ = 0, n_tets_ = 0;
  GridPoint lowest_ = {kRootWidth, kRootWidth, kRootWidth}, highest_ = {0, 0, 0};
  IdSet first_vertices_;                ///< first vertices of the cells; has room for the rank after the last vertex
  std::vector<std::int32_t> tet_cell_;  ///< cell of every 16th tet
};

/// Reader with the results of OctreeTets::tet(), for tets with nearby ids, or tets in the stars of nearby vertices. It
/// looks up the vertices of a leaf, which belong to a dozen tets, only once. Use it in one thread.
class OctreeTets::Reader {
 public:
  explicit Reader(const OctreeTets& tets) : tets_(&tets), leaves_(kLeaves) {}
  std::array<std::int64_t, 4> tet(std::int64_t tet);

 private:
  // Eight leaves, or up to 25, are around a vertex; the leaves of the next vertex are nearly the same.
  static constexpr std::size_t kLeaves = 64;
  static constexpr std::int64_t kUnknown = -2;

  struct Leaf {
    int cell = -1;
    std::array<std::int64_t, 27> vertex;  ///< vertices by code_index()
  };

  const OctreeTets* tets_;
  int last_ = -1;
  std::vector<Leaf> leaves_;  ///< entries indexed by the last bits of the leaf number
};

}  // namespace umtet
