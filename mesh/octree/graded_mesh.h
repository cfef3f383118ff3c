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

/// Parameters of a GradedMesh. Several threads call the functions at once.
struct Grading {
  Eigen::AlignedBox3d box;  ///< the region to be covered
  double finest = 0;        ///< mean edge length of the smallest tets, model units; half of it gives the same root cube
  /// The least mean edge length required in the cube with this centre and half width.
  std::function<double(const Vec3& centre, double half_width)> size;
  double tolerance = 1;  ///< leaves are split while their mean edge length exceeds tolerance * size
  /// Whether a cube meets the region of interest. If it does not, its eight children are omitted, and the background
  /// has a boundary there. Empty: all cubes are kept.
  std::function<bool(const Vec3& centre, double half_width)> wanted = {};
  std::size_t max_leaves = std::size_t{1} << 26;  ///< a leaf takes about 60 bytes and has a dozen tets
  int transition_sweeps = 8;  ///< sweeps of smooth_transitions(); 0: vertices stay at corners and centres of leaves
};

/// A graded background mesh: BCC tets on an octree in which adjacent leaves differ by at most one level, as in
/// isosurface stuffing [Labelle2007].
///
/// In a region of one size the tets are those of two interleaved cubic lattices, the corners and the centres of leaves:
/// Q = .9524, dihedral angles of 60 and 90 degrees. Between two sizes they are halves and quarters of such tets, and
/// halves of the pyramids over the small faces (tet_slots.h): Q >= .756, 45 to 120 degrees, and better after smoothing
/// (transition_smoothing.h). At the background boundary they are halved at the faces of leaves, which makes the
/// boundary flat.
///
/// Only leaves are stored (linear_octree.h). Vertices and tets have dense ids in the order of the leaves, and all other
/// data are computed. Ids change with the grading; key() and tet_key() are the same in any grading of the same root
/// cube. Immutable and thread-safe; the mesh does not depend on the number of threads.
class GradedMesh {
 public:
  /// The root cube is centred at the box; its width is the width of the smallest leaves times a power of two.
  /// \throw std::invalid_argument for an empty box, finest <= 0, tolerance <= 0, no size function or a size that is not
  ///        > 0, more than kMaxOctreeLevel levels, more than max_leaves leaves, or 2^31 vertices
  explicit GradedMesh(const Grading& grading);

  /// The part of this mesh around some vertices: the leaves around them and around vertices within `rings` edges of
  /// them, and the siblings of these leaves. Vertices and tets keep their keys. The boundary is beyond all these
  /// vertices. If rings > 0, the tets at the given vertices are the same.
  /// @param transition_sweeps  number of sweeps, as in Grading
  GradedMesh around(const IdSet& vertices, int rings, int transition_sweeps = 8) const;

  std::int64_t n_vertices() const { return tets_.n_vertices(); }
  std::int64_t n_tets() const { return tets_.n_tets(); }
  std::int64_t n_leaves() const { return tets_.n_leaves(); }
  Eigen::AlignedBox3d box() const;  ///< bounding box of the vertices
  /// Mean edge length of the smallest tets.
  double finest() const { return finest_; }
  std::size_t n_bytes() const;  ///< memory used

  Vec3 position(std::int64_t vertex) const;
  /// Morton key of the vertex in the root cube.
  std::uint64_t key(std::int64_t vertex) const { return tets_.key(vertex); }
  /// The vertex with this key, or -1.
  std::int64_t vertex_of(std::uint64_t key) const { return tets_.vertex_of(key); }
  /// 64 (cube_key() of the leaf) + slot.
  std::uint64_t tet_key(std::int64_t tet) const { return tets_.tet_key(tet); }
  std::array<std::int64_t, 4> tet(std::int64_t tet) const { return tets_.tet(tet); }
  using Reader = OctreeTets::Reader;
  Reader reader() const { return Reader(tets_); }
  /// Appends the tets at a vertex, ascending.
  void star(std::int64_t vertex, std::vector<std::int64_t>& tets) const { tets_.star(vertex, tets); }
  /// Appends the vertices that share an edge with the vertex, ascending.
  void link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const { tets_.link(vertex, vertices); }
  /// Lists the vertices that share an edge with the vertex, by z, then y, then x of their positions relative to it.
  /// Returns false and lists nothing if some tet at the vertex is not a BCC tet, or the tets have several sizes.
  bool bcc_link(std::int64_t vertex, BccLink& vertices) const;
  /// The tet behind the face opposite to local vertex `face`, or -1.
  std::int64_t neighbor(std::int64_t tet, int face) const { return tets_.neighbor(tet, face); }
  /// Mean length of the edges at a vertex before smoothing of transitions, model units.
  double mean_edge(std::int64_t vertex) const { return unit_ * tets_.mean_edge(vertex); }
  bool on_boundary(std::int64_t vertex) const { return tets_.on_boundary(vertex); }
  /// True if a tet is not a BCC tet: it lies between two sizes, or is a half.
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

}  // namespace umtet
