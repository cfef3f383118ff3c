#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/fast/flips/detail/edge_rings.h"

namespace umtet::detail {

/// A local operation of flip_locally() on the tets around a tet.
struct FlipCandidate {
  enum class Operation {
    Smooth,     ///< vertices move one by one
    SmoothAll,  ///< all vertices of the patch move at once (all_vertex_smoothing.h)
    RemoveEdge,
    Collapse
  };

  bool changes_tets() const { return operation == Operation::RemoveEdge || operation == Operation::Collapse; }

  Operation operation = Operation::Smooth;
  int a = -1, b = -1;         ///< the edge that is removed, or the vertex a that collapses into b
  double least = 0;           ///< mean ratio of the worst new tet, before its vertices move
  std::vector<int> old_tets;  ///< ascending
  std::vector<Tet> new_tets;
  std::vector<int> new_regions;  ///< per new tet; empty: one region
};

/// The removals and collapses of the edges of a tet that are worth a trial, those with the best worst tet first, at
/// most `most` of them.
/// @param promising  an operation whose worst new tet is below this share of the tet's own mean ratio is left out
std::vector<FlipCandidate> edge_operations(const ChangingMesh& mesh, int tet, double promising, std::size_t most);

/// The tets that share a vertex with a tet, unchanged: FlipCandidate::Operation::Smooth.
FlipCandidate smoothing_around(const ChangingMesh& mesh, int tet);

}  // namespace umtet::detail
