#pragma once

#include <filesystem>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// File format of a surface.
enum class SurfaceFormat { Stl, Obj, Ply };  ///< binary STL and PLY, text OBJ

/// Writes triangles. The caller sees the complete file or none.
///
/// Only vertices used by faces are written, in their order. All three formats store single precision: keep model
/// coordinates near the origin if 7 digits matter.
/// \throw std::invalid_argument for an index out of range or a face with a repeated vertex; std::system_error naming
///        the path if a write fails
void write_surface(const std::filesystem::path& path, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                   SurfaceFormat format);

}  // namespace umtet
