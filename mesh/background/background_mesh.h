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

/// The background (universal) mesh: a lattice, a graded mesh, or a stored tet mesh.
///
/// A lattice is implicit, made of copies of an acute tiling; nothing is stored per vertex or tet. Cells (i, j, k) with
/// 0 <= i, j, k < n, one period of the tiling each, hold the tets; their vertices live in cells -1 .. n. Ids are
/// 64-bit: vertex = type + n_types * (cell index in the (n + 2)^3 range), tet = tet of the cell + tets of a cell *
/// (cell index in the n^3 range). A15 has 8 types and 46 tets. Ids ascend with x fastest, then y, then z. The object is
/// immutable; one mesh serves any number of domains and threads.
///
/// In a graded or stored mesh, ids are its vertex and tet numbers, and the description of cells and types does not
/// apply. All kinds are one class because every call is about one vertex or one tet: the test of the kind is a branch
/// that is always predicted, whereas a template would double all code built on backgrounds.
class BackgroundMesh {
 public:
  /// Lattice that covers `box` with whole cells, including the cells needed for pits at the walls (overhang(): a
  /// quarter cell for A15). The excess is split equally between both sides.
  /// @param h  mean edge length, model units
  /// \throw std::invalid_argument for h <= 0, an empty box, or more than 2^40 tets
  BackgroundMesh(const Tiling& tiling, const Box& box, double h);
  /// A stored mesh; h is its mean edge length. \throw std::invalid_argument under the conditions of ExplicitMesh
  explicit BackgroundMesh(TetMesh mesh);
  /// A graded mesh; h is the mean edge length of its smallest tets.
  explicit BackgroundMesh(GradedMesh mesh);

  bool is_lattice() const { return is_lattice_; }
  bool is_stored() const { return explicit_ != nullptr; }     ///< stored tet by tet
  const GradedMesh* graded() const { return graded_.get(); }  ///< null for other kinds
  /// The tiling; for other kinds it has no points and no name.
  const Tiling& tiling() const { return tiling_; }
  double h() const { return h_; }
  /// Mean length of the edges at this vertex, model units; equal to h() for any vertex of a lattice.
  double h(std::int64_t vertex) const { return is_lattice_ ? h_ : mean_edge(vertex); }
  Box box() const;  ///< the block of cells, or the bounding box of the vertices
  std::int64_t n_vertices()
      const;  ///< size of the id range, including vertices without a tet at the background boundary
  std::int64_t n_tets() const;
  /// origin + unit * (an exact multiple of a quarter for A15), with two roundings per coordinate.
  Vec3 position(std::int64_t vertex) const;
  std::array<std::int64_t, 4> tet(std::int64_t tet) const;
  /// Appends the ids of the tets at `vertex` that lie inside the mesh, ascending.
  void star(std::int64_t vertex, std::vector<std::int64_t>& tets) const;
  /// Appends the vertices that share an edge with `vertex`, ascending.
  void link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const;
  /// GradedMesh::bcc_link() of a graded mesh; returns false for other kinds.
  bool bcc_link(std::int64_t vertex, BccLink& vertices) const;
  /// True if some tet of the tiling at `vertex` is missing from the lattice, or if the vertex is on the boundary of a
  /// graded or stored mesh.
  bool on_boundary(std::int64_t vertex) const;
  /// True only if no vertex from `first` to `last` is on the background boundary. Costs as much as two vertices; finds
  /// it for ranges within a row of a lattice's cells.
  bool is_off_boundary(std::int64_t first, std::int64_t last) const;
  /// True if `vertex` is a corner of some tet of the mesh.
  bool has_tets(std::int64_t vertex) const;
  /// The tet behind the face opposite to local vertex `face`, or -1 at the background boundary.
  std::int64_t neighbor(std::int64_t tet, int face) const;
  /// A tet near x, to start a local search, or -1 outside the box. In a lattice its cell contains x; in a graded mesh
  /// the tet contains x; in a stored mesh it is at the nearest vertex, found by a search over all vertices.
  std::int64_t tet_near(const Vec3& x) const;
  /// Persistent ids. In a graded mesh they are the same in any grading of its root cube (GradedMesh::key()); in other
  /// kinds they equal the ids.
  std::int64_t key_of_vertex(std::int64_t vertex) const;
  /// The vertex with this key, or -1.
  std::int64_t vertex_of_key(std::int64_t key) const;

  // The functions below are for lattices only.
  using Cell = std::array<std::int64_t, 3>;
  const TilingTables& tiling_tables() const { return tables_; }
  int n_types() const { return n_types_; }
  int type(std::int64_t vertex) const { return static_cast<int>(vertex % n_types_); }
  const Cell& n_cells() const { return n_; }
  Cell cell(std::int64_t vertex) const { return vertex_address(vertex).cell; }
  /// Difference between the id of a corner and the id of a vertex of type `from`, for any vertex of that type whose
  /// cell is in the range of ids together with the corner's cell. Vertices off the background boundary reach their
  /// whole link this way. From a vertex in the outermost layer of cells, a step out of the range gives a number that is
  /// not an id, or the id of another vertex in the outermost layer, which is on the background boundary.
  std::int64_t id_step(int from, const Tiling::Corner& to) const {
    return to.type - from + n_types_ * (to.offset[0] + (n_[0] + 2) * (to.offset[1] + (n_[1] + 2) * to.offset[2]));
  }
  std::int64_t vertex_id(int type, const Cell& cell) const;
  /// The cells first .. first + n - 1 as a separate lattice, for a process that needs no others. It has its own ids,
  /// which ascend in the same order as those of the whole; positions equal those of the whole to the bit. The part ends
  /// where its cells end: vertices there are on its background boundary. \throw std::invalid_argument if the cells are
  /// not in this lattice
  BackgroundMesh part(const Cell& first, const Cell& n) const;
  const Cell& first_cell() const { return first_; }  ///< position in the whole lattice; 0 if this is not a part

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
  std::shared_ptr<const GradedMesh> graded_;      ///< null for other kinds
  Tiling tiling_;
  TilingTables tables_;
  double h_, unit_;  ///< unit_: model units per unit of the tiling
  Vec3 origin_;
  Cell n_;           ///< cells in x, y, z
  Cell first_ = {};  ///< position in the whole lattice of cell (0, 0, 0) of a part
  int n_types_, n_cell_tets_;
};

}  // namespace umtet
