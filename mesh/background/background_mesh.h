#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mesh/background/explicit_mesh.h"
#include "mesh/background/tiling.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/octree/bcc_link.h"

namespace umtet {

class GradedMesh;

using Box = Eigen::AlignedBox3d;

/// The universal mesh as an implicit lattice of copies of an acute tiling: nothing is stored per vertex or tet.
///
/// Cells (i, j, k) with 0 <= i, j, k < n, one period of the tiling each, hold the tets; their vertices live in cells
/// -1 .. n. Ids are 64-bit: vertex = type + n_types * (cell index in the (n + 2)^3 range), tet = tet of the cell + tets
/// of a cell * (cell index in the n^3 range). A15 has 8 types and 46 tets.
/// Ids ascend with x fastest, then y, then z. Immutable; one mesh serves any number of domains and threads.
///
/// Or a graded mesh, or any other tet mesh as it is stored: ids are then its vertex and tet numbers, and what is said
/// of cells and types does not apply. All are one class because every call is about one vertex or one tet: to tell the
/// kinds apart costs a branch that is always predicted, where a template would double all that is built on backgrounds.
class BackgroundMesh {
 public:
  /// Covers `box` with whole cells, as many as their pits at the walls ask for (overhang(): a quarter cell for A15);
  /// what is too much is shared by both sides.
  /// @param h  mean edge length, model units
  /// \throw std::invalid_argument for h <= 0, an empty box, or more than 2^40 tets
  BackgroundMesh(const Tiling& tiling, const Box& box, double h);
  /// The mesh as it is; h is its mean edge length. \throw std::invalid_argument for what ExplicitMesh refuses
  explicit BackgroundMesh(TetMesh mesh);
  /// h is the mean edge length of its smallest tets.
  explicit BackgroundMesh(GradedMesh mesh);

  bool is_lattice() const { return is_lattice_; }
  bool is_stored() const { return explicit_ != nullptr; }     ///< tet by tet, whoever made it
  const GradedMesh* graded() const { return graded_.get(); }  ///< null for all others
  /// Of no points and no name for another mesh.
  const Tiling& tiling() const { return tiling_; }
  double h() const { return h_; }
  /// Mean length of the edges at this vertex, model units; of a lattice h(), whichever vertex.
  double h(std::int64_t vertex) const { return is_lattice_ ? h_ : mean_edge(vertex); }
  Box box() const;  ///< the block of cells, or the bounding box
  std::int64_t n_vertices()
      const;  ///< size of the id range, vertices without a tet at the background boundary included
  std::int64_t n_tets() const;
  /// origin + unit * (an exact multiple of a quarter for A15): two roundings per coordinate.
  Vec3 position(std::int64_t vertex) const;
  std::array<std::int64_t, 4> tet(std::int64_t tet) const;
  /// Appends the ids of the tets at `vertex` that lie inside the mesh, ascending.
  void star(std::int64_t vertex, std::vector<std::int64_t>& tets) const;
  /// Appends the vertices that share an edge with `vertex`, ascending.
  void link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const;
  /// GradedMesh::bcc_link(); false in any other mesh.
  bool bcc_link(std::int64_t vertex, BccLink& vertices) const;
  /// True if some tet of the tiling at `vertex` is missing from the mesh, or if it is on the boundary of an other mesh.
  bool on_boundary(std::int64_t vertex) const;
  /// True only if no vertex from `first` to `last` is on the background boundary: at the cost of two of them, true of
  /// runs within a row of a lattice's cells.
  bool is_off_boundary(std::int64_t first, std::int64_t last) const;
  /// True if some tet of the mesh has `vertex` as a corner.
  bool has_tets(std::int64_t vertex) const;
  /// The tet behind the face opposite to local vertex `face`, or -1 at the background boundary.
  std::int64_t neighbor(std::int64_t tet, int face) const;
  /// Some tet whose cell contains x (a place to start a local search), or -1 outside the box. In a graded mesh the one
  /// that contains x; in a stored one one at the nearest vertex, by looking at all.
  std::int64_t tet_near(const Vec3& x) const;
  /// Names that outlast the mesh: those of a graded mesh are the same in any grading of its root cube
  /// (GradedMesh::key()), elsewhere they are the ids.
  std::int64_t key_of_vertex(std::int64_t vertex) const;
  std::int64_t key_of_tet(std::int64_t tet) const;
  /// The vertex of this key, or -1.
  std::int64_t vertex_of_key(std::int64_t key) const;

  // From here on: of a lattice.
  using Cell = std::array<std::int64_t, 3>;
  const TilingTables& tiling_tables() const { return tables_; }
  int n_types() const { return n_types_; }
  int type(std::int64_t vertex) const { return static_cast<int>(vertex % n_types_); }
  const Cell& n_cells() const { return n_; }
  Cell cell(std::int64_t vertex) const { return vertex_address(vertex).cell; }
  /// id of a corner minus id of a vertex of type `from`, for any vertex of that type whose cell and the corner's are in
  /// the range of ids. Vertices off the background boundary reach their whole link this way; from a vertex in the
  /// outermost layer of cells a step out of the range gives no id, or that of another vertex in the outermost layer,
  /// which is on the background boundary.
  std::int64_t id_step(int from, const Tiling::Corner& to) const {
    return to.type - from + n_types_ * (to.offset[0] + (n_[0] + 2) * (to.offset[1] + (n_[1] + 2) * to.offset[2]));
  }
  std::int64_t vertex_id(int type, const Cell& cell) const;
  /// The cells first .. first + n - 1 as a lattice of their own, for a process that needs no others. Ids are its own
  /// and ascend as those of the whole do; positions are those of the whole, to the bit. It ends where its cells end:
  /// vertices there are on its background boundary. \throw std::invalid_argument for cells that are not in this one
  BackgroundMesh part(const Cell& first, const Cell& n) const;
  const Cell& first_cell() const { return first_; }  ///< in the whole lattice; 0 of one that is no part

 private:
  struct VertexAddress {
    int type;
    Cell cell;
  };
  double mean_edge(std::int64_t vertex) const;
  VertexAddress vertex_address(std::int64_t vertex) const;
  bool is_deep(const Cell& cell) const;
  bool holds(const Cell& cell, const std::array<int, 3>& offset) const;
  std::int64_t tet_id(int tet, const Cell& cell, const std::array<int, 3>& offset) const;

  bool is_lattice_;
  std::shared_ptr<const ExplicitMesh> explicit_;  ///< null for a lattice and a graded mesh
  std::shared_ptr<const GradedMesh> graded_;      ///< null for all others
  Tiling tiling_;
  TilingTables tables_;
  double h_, unit_;  ///< unit_: of the tiling's lengths, in model units
  Vec3 origin_;
  Cell n_;           ///< cells in x, y, z
  Cell first_ = {};  ///< of a part: the place of its cell (0, 0, 0)
  int n_types_, n_cell_tets_;
};

}  // namespace umtet
