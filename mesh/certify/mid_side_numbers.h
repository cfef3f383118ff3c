#pragma once

#include <vector>

#include "mesh/core/quadratic_tet_mesh.h"

namespace umtet {

/// The edges of a tet mesh, numbered: ascending in their lower vertex, then in the other.
class MidSideNumbers {
 public:
  /// \throw std::invalid_argument naming the first tet with an index outside 0 .. n_vertices - 1 or a repeated vertex
  /// Cost: O(n_tets), threads over vertices, result independent of them; 24 bytes a tet while it runs.
  MidSideNumbers(const std::vector<Tet>& C, std::size_t n_vertices);

  std::size_t n_edges() const { return higher_.size(); }
  /// Number of the edge between two vertices, -1 where there is none.
  int operator()(int a, int b) const;

  /// The mesh with straight edges and a node at the middle of each: vertex n_vertices + number.
  QuadraticTetMesh straight_mesh(const TetMesh& mesh) const;

 private:
  std::vector<int> first_;   ///< by vertex: number of its first edge to a higher one
  std::vector<int> higher_;  ///< by edge: the higher vertex
};

}  // namespace umtet
