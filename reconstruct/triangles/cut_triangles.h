#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Triangles cut into pieces, without labels.
struct TrianglePieces {
  TriangleMesh mesh;
  std::vector<std::uint32_t> of;  ///< the original triangle of each piece
};

/// Bisects the longest edge of triangles until none is longer than `most`, or there are `most_pieces`.
TrianglePieces cut_triangles(const TriangleMesh& mesh, double most, std::size_t most_pieces);

}  // namespace umtet
