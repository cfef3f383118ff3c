#pragma once

#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet::detail {

/// An edge of the boundary with its two faces.
struct SharedEdge {
  int v, w;  ///< corners, v < w
  int face, other;
};

/// The edges shared by exactly two boundary faces, by corners.
std::vector<SharedEdge> shared_edges(const std::vector<Triangle>& faces);

}  // namespace umtet::detail
