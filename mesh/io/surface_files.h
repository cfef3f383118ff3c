#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

enum class SurfaceFormat { Stl, Obj, Ply };  ///< binary STL and PLY, text OBJ

/// Writes a surface through OpenMesh, complete or not at all as far as the caller is concerned.
///
/// Only vertices that faces use are written. All three hold single precision, because OpenMesh's exporters do: keep
/// model coordinates near the origin when 7 digits matter.
/// \throw std::invalid_argument when the faces are not a manifold; std::system_error naming the path when a write fails
void write_surface(const std::filesystem::path& path, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                   SurfaceFormat format);

/// What OpenMesh's half-edge structure makes of a surface: an independent second opinion on surface_topology().
struct HalfEdgeCount {
  std::size_t n_refused_faces = 0;  ///< faces it cannot hold, because they would make the surface no 2-manifold
  bool has_boundary = false;        ///< a half-edge without a face
};
/// \throw std::invalid_argument for an index out of range or a face with a repeated vertex
HalfEdgeCount count_half_edges(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);

}  // namespace umtet
