#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Triangles in pieces, without labels.
struct TrianglePieces {
  TriangleMesh mesh;
  std::vector<std::uint32_t> of;  ///< which triangle each piece is of
};

/// Cuts the longest edge of what is longer than `most` in the middle until nothing is, or there are `most_pieces`.
TrianglePieces cut_triangles(const TriangleMesh& mesh, double most, std::size_t most_pieces);

}  // namespace umtet
