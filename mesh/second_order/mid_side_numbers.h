#pragma once

#include <vector>

#include "mesh/core/quadratic_tet_mesh.h"

namespace umtet {

/// Numbering of the edges of a tet mesh, ascending by lower vertex, then by the other.
class MidSideNumbers {
 public:
  /// \throw std::invalid_argument naming the first tet with an index outside 0 .. n_vertices - 1 or a repeated vertex
  /// Cost: O(n_tets), with 24 bytes of working memory per tet. Uses threads over vertices; the result does not depend
  /// on them.
  MidSideNumbers(const std::vector<Tet>& C, std::size_t n_vertices);

  std::size_t n_edges() const { return higher_.size(); }
  /// Number of the edge between two vertices; -1 if there is no such edge.
  int operator()(int a, int b) const;

  /// The quadratic mesh with straight edges and a node at the middle of each edge: vertex n_vertices + number.
  QuadraticTetMesh straight_mesh(const TetMesh& mesh) const;

 private:
  std::vector<int> first_;   ///< for each vertex, the number of its first edge to a higher vertex
  std::vector<int> higher_;  ///< for each edge, the higher vertex
};

}  // namespace umtet
