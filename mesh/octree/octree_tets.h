#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/base/id_set.h"
#include "mesh/octree/bcc_link.h"
#include "mesh/octree/linear_octree.h"

namespace umtet {

/// The tets on the leaves of an octree (tet_slots.h), and who meets whom, in the octree's grid.
///
/// Vertices and tets have dense ids in the order of the leaves. Nothing is stored of either: all is computed from
/// leaves, their neighbours, and how many vertices and tets come before each leaf. Immutable.
class OctreeTets {
 public:
  /// @param cubes  sorted cube_key()s of a balanced octree
  explicit OctreeTets(const std::vector<std::uint64_t>& cubes);

  std::int64_t n_vertices() const { return octree_.n_vertices(); }
  std::int64_t n_tets() const { return n_tets_; }
  std::int64_t n_leaves() const { return n_leaves_; }
  const GridPoint& lowest() const { return lowest_; }  ///< corner of the bounding box
  const GridPoint& highest() const { return highest_; }
  std::size_t n_bytes() const;  ///< of memory that is kept

  std::uint64_t key(std::int64_t vertex) const;
  std::int64_t vertex_of(std::uint64_t key) const;
  std::uint64_t tet_key(std::int64_t tet) const;
  std::array<std::int64_t, 4> tet(std::int64_t tet) const;
  void star(std::int64_t vertex, std::vector<std::int64_t>& tets) const;
  void link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const;
  /// Those of link(), in the order of their places around the vertex: by z, then y, then x. False, and nothing, where
  /// some tet at the vertex is none of BCC or of another size.
  bool bcc_link(std::int64_t vertex, BccLink& vertices) const;
  std::int64_t neighbor(std::int64_t tet, int face) const;
  bool on_boundary(std::int64_t vertex) const;
  /// These vertices and those within `rings` edges of them.
  IdSet with_rings(const IdSet& vertices, int rings) const;
  /// Sorted keys of the leaves around these vertices, and of siblings of these: of an octree in which tets are on all
  /// sides of each. They are other tets only where the edge of a leaf is no longer split.
  std::vector<std::uint64_t> leaves_at(const IdSet& vertices) const;
  /// Mean length of the edges at a vertex.
  double mean_edge(std::int64_t vertex) const;
  /// Some tet with the centre of the leaf that a point is in, or -1.
  std::int64_t tet_near(const GridPoint& p) const;
  /// Whether a tet is none of BCC: between two sizes, or a half.
  bool is_transition(std::int64_t tet) const;
  /// The corners of tets between two sizes.
  IdSet transition_vertices() const;
  class Reader;

 private:
  /// The leaves around a vertex that is no centre, and where it is in them.
  struct Around {
    int n = 0;
    std::array<std::pair<int, int>, 8> leaves;  ///< with code_index()
    bool of_one_size = false;                   ///< eight, by octant
    bool is_complete = true;                    ///< no leaf is missing
  };
  /// Leaves around a vertex with bits of their slots: of a centre, its own and 24 small ones behind its faces.
  struct Star {
    int n = 0;
    std::array<std::pair<int, std::uint64_t>, 25> parts;
    void add(int leaf, std::uint64_t slots) {
      if (slots != 0) parts[static_cast<std::size_t>(n++)] = {leaf, slots};
    }
    void sort();
  };
  /// With repetitions: of a centre up to 33 of its own leaf and 5 of each of 24 small ones; of a point less.
  using Link = std::array<std::int64_t, 192>;

  void find_slots(int leaf);
  int cell_of_vertex(std::int64_t vertex) const;
  int cell_of_tet(std::int64_t tet) const;
  bool is_centre(std::int64_t vertex) const;
  std::int64_t vertex_id(const LinearOctree::VertexPlace& place) const;
  std::int64_t centre_id(int leaf) const { return vertex_id({leaf, 7}); }
  std::int64_t tet_id(int leaf, int slot) const;
  std::array<std::int64_t, 4> corners(int leaf, int slot) const;
  /// @param vertex  of each place in the leaf but its centre
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
  /// Whether all tets at a vertex are BCC tets of one size.
  bool is_regular(std::int64_t vertex) const;
  int link_of(std::int64_t vertex, Link& link) const;

  LinearOctree octree_;
  std::int64_t n_leaves_ = 0, n_tets_ = 0;
  GridPoint lowest_ = {kRootWidth, kRootWidth, kRootWidth}, highest_ = {0, 0, 0};
  IdSet first_vertices_;                ///< of the cells, and room for the rank of what comes after the last vertex
  std::vector<std::int32_t> tet_cell_;  ///< of every 16th tet
};

/// OctreeTets::tet() for tets that are near each other in the order of their ids, or in stars of vertices that are: the
/// vertices on a leaf, which belong to a dozen of tets, are looked for once. Of one thread.
class OctreeTets::Reader {
 public:
  explicit Reader(const OctreeTets& tets) : tets_(&tets), leaves_(kLeaves) {}
  std::array<std::int64_t, 4> tet(std::int64_t tet);

 private:
  // Around a vertex are eight leaves, or up to 25; those of the next vertex are nearly the same.
  static constexpr std::size_t kLeaves = 64;
  static constexpr std::int64_t kUnknown = -2;

  struct Leaf {
    int cell = -1;
    std::array<std::int64_t, 27> vertex;  ///< by code_index()
  };

  const OctreeTets* tets_;
  int last_ = -1;
  std::vector<Leaf> leaves_;  ///< by the last bits of their numbers
};

}  // namespace umtet
