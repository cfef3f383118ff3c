#pragma once

#include <span>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A stored tet mesh with its adjacency lists, used as a background mesh without a lattice. Lists ascend. About 60
/// bytes per tet. Immutable.
class ExplicitMesh {
 public:
  /// \throw std::invalid_argument naming the first violation: no tets, an index out of range, an inverted or flat tet
  ///        (exact test), a face of three tets, or a face with two tets on the same side
  explicit ExplicitMesh(TetMesh mesh);

  const TetMesh& mesh() const { return mesh_; }
  double mean_edge() const { return mean_edge_; }
  /// Mean length of the edges at a vertex; 0 for a vertex without edges.
  double mean_edge(int vertex) const { return mean_edge_at_[vertex]; }
  /// The tets at a vertex.
  std::span<const int> star(int vertex) const { return list(star_begin_, star_, vertex); }
  /// The vertices that share an edge with the vertex.
  std::span<const int> link(int vertex) const { return list(link_begin_, link_, vertex); }
  /// The tet behind the face opposite to local vertex `face`, or -1.
  int neighbor(int tet, int face) const { return neighbor_[4 * static_cast<std::size_t>(tet) + face]; }
  /// True for a vertex of a face that belongs to one tet only.
  bool on_boundary(int vertex) const { return on_boundary_[vertex]; }
  /// A tet at the vertex nearest to x, by a search over all vertices, or -1 outside the bounding box.
  int tet_near(const Vec3& x) const;

 private:
  static std::span<const int> list(const std::vector<std::size_t>& begin, const std::vector<int>& items, int i) {
    return {items.data() + begin[i], items.data() + begin[i + 1]};
  }
  void check_tets() const;
  void find_stars();
  void find_neighbors();
  void find_links();

  TetMesh mesh_;
  double mean_edge_ = 0;
  std::vector<double> mean_edge_at_;
  std::vector<std::size_t> star_begin_, link_begin_;
  std::vector<int> star_, link_, neighbor_;
  std::vector<bool> on_boundary_;
};

}  // namespace umtet
