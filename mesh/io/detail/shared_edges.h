#pragma once

#include <vector>

#include "mesh/io/solver_mesh.h"

namespace umtet::detail {

/// An edge of the boundary with its two faces.
struct SharedEdge {
  int v, w;  ///< corners, v < w
  int face, other;
};

/// The edges that two boundary faces have, by corners; those of one or of more than two join nothing.
std::vector<SharedEdge> shared_edges(const SolverMesh& mesh);

}  // namespace umtet::detail
