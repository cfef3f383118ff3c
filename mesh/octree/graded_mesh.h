#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/octree/octree_tets.h"
#include "mesh/octree/transition_smoothing.h"

namespace umtet {

/// What a GradedMesh is made for. The functions are called by several threads at once.
struct Grading {
  Eigen::AlignedBox3d box;  ///< is covered
  double finest = 0;        ///< mean edge length of the smallest tets, model units; half of it has the same root cube
  /// The least mean edge length that is wanted in the cube of this centre and half width.
  std::function<double(const Vec3& centre, double half_width)> size;
  double tolerance = 1;  ///< leaves split while their mean edge length exceeds that times the size
  /// Whether a cube meets the region of interest. The eight children of one that does not are left out, and the
  /// background has a boundary there. Empty: all are kept.
  std::function<bool(const Vec3& centre, double half_width)> wanted = {};
  std::size_t max_leaves = std::size_t{1} << 26;  ///< about 60 bytes each, and a dozen tets
  int transition_sweeps = 8;  ///< smooth_transitions(); 0: vertices are corners and centres of leaves
};

/// A universal mesh whose tets grow and shrink: BCC tets on an octree in which leaves that touch differ by one level at
/// most, as in isosurface stuffing [Labelle2007].
///
/// Within a region of one size the tets are those of two interleaved cubic lattices, corners and centres of leaves: Q =
/// .9524, dihedral angles of 60 and 90 degrees. Between two sizes they are halves and quarters of such tets and halves
/// of the pyramids over the small faces (tet_slots.h): Q >= .756, 45 to 120 degrees, and better once
/// smoothed (transition_smoothing.h). At the background boundary they
/// are halved at the faces of leaves, which makes it flat.
///
/// Only leaves are stored (linear_octree.h); vertices and tets are dense ids in the order of the leaves, and everything
/// else is computed. Ids change with the grading; key() and tet_key() do not, in any grading of the same root cube.
/// Immutable, for any number of threads, and the same whatever their number.
class GradedMesh {
 public:
  /// The root cube is centred at the box, its width that of the smallest leaves times a power of two.
  /// \throw std::invalid_argument for an empty box, finest <= 0, tolerance <= 0, no size or one that is not > 0, more
  ///        than kMaxOctreeLevel levels or max_leaves, or 2^31 vertices
  explicit GradedMesh(const Grading& grading);

  /// The same with those leaves alone that are around these vertices and vertices within `rings` edges of them, and
  /// with siblings of these. Vertices and tets keep their keys. The boundary is beyond all these vertices, and if rings
  /// > 0 the tets at those given are the same.
  /// @param transition_sweeps  as in Grading
  GradedMesh around(const IdSet& vertices, int rings, int transition_sweeps = 8) const;

  std::int64_t n_vertices() const { return tets_.n_vertices(); }
  std::int64_t n_tets() const { return tets_.n_tets(); }
  std::int64_t n_leaves() const { return tets_.n_leaves(); }
  Eigen::AlignedBox3d box() const;  ///< of the vertices
  /// Mean edge length of the smallest tets.
  double finest() const { return finest_; }
  std::size_t n_bytes() const;                                                            ///< of memory that is kept
  std::int64_t n_moved() const { return static_cast<std::int64_t>(offsets_.by.size()); }  ///< by smooth_transitions()

  Vec3 position(std::int64_t vertex) const;
  /// Morton key of the vertex in the root cube.
  std::uint64_t key(std::int64_t vertex) const { return tets_.key(vertex); }
  /// The vertex of this key, or -1.
  std::int64_t vertex_of(std::uint64_t key) const { return tets_.vertex_of(key); }
  /// 64 (cube_key() of the leaf) + slot.
  std::uint64_t tet_key(std::int64_t tet) const { return tets_.tet_key(tet); }
  std::array<std::int64_t, 4> tet(std::int64_t tet) const { return tets_.tet(tet); }
  using Reader = OctreeTets::Reader;
  Reader reader() const { return Reader(tets_); }
  /// Appends the tets at a vertex, ascending.
  void star(std::int64_t vertex, std::vector<std::int64_t>& tets) const { tets_.star(vertex, tets); }
  /// Appends the vertices that share an edge with it, ascending.
  void link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const { tets_.link(vertex, vertices); }
  /// The same by z, then y, then x of their places around the vertex; false, and nothing, where not all tets at it are
  /// BCC tets of one size as the octree has them.
  bool bcc_link(std::int64_t vertex, BccLink& vertices) const;
  /// The tet behind the face opposite to local vertex `face`, or -1.
  std::int64_t neighbor(std::int64_t tet, int face) const { return tets_.neighbor(tet, face); }
  /// Mean length of the edges at a vertex before transitions are smoothed, model units.
  double mean_edge(std::int64_t vertex) const { return unit_ * tets_.mean_edge(vertex); }
  bool on_boundary(std::int64_t vertex) const { return tets_.on_boundary(vertex); }
  /// Whether a tet is none of BCC: between two sizes, or a half.
  bool is_transition(std::int64_t tet) const { return tets_.is_transition(tet); }
  /// The tet that contains x, or -1 outside of all leaves.
  std::int64_t tet_at(const Vec3& x) const;

 private:
  GradedMesh(double finest, double unit, Vec3 origin, OctreeTets tets)
      : finest_(finest), unit_(unit), origin_(std::move(origin)), tets_(std::move(tets)) {}

  double finest_ = 0, unit_ = 0;
  Vec3 origin_;
  OctreeTets tets_;
  VertexOffsets offsets_;
};

/// The same mesh, stored. \throw std::invalid_argument for more than 2^31 - 1 tets
TetMesh to_tet_mesh(const GradedMesh& mesh);

}  // namespace umtet
