#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// File format of a surface.
enum class SurfaceFormat { Stl, Obj, Ply };  ///< binary STL and PLY, text OBJ

/// Writes a surface through OpenMesh. The caller sees the complete file or none.
///
/// Only vertices used by faces are written. All three formats store single precision, because OpenMesh's exporters do:
/// keep model coordinates near the origin if 7 digits matter.
/// \throw std::invalid_argument if the faces are not a manifold; std::system_error naming the path if a write fails
void write_surface(const std::filesystem::path& path, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                   SurfaceFormat format);

/// Result of building OpenMesh's half-edge structure of a surface: an independent check of surface_topology().
struct HalfEdgeCount {
  std::size_t n_refused_faces = 0;  ///< faces rejected because they would make the surface non-manifold
  bool has_boundary = false;        ///< true if a half-edge has no face
};
/// Builds the half-edge structure. \throw std::invalid_argument for an index out of range or a face with a repeated
/// vertex
HalfEdgeCount count_half_edges(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);

}  // namespace umtet
