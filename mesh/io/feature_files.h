#pragma once

#include <filesystem>

#include "mesh/features/piecewise_mesh.h"

namespace umtet {

/// Writes the sharp edges of a mesh as lines in VTK XML polydata: one line for each curve with `curve` (its number), `patch_1`,
/// `patch_2` (numbers from 1), `angle_deg` (least dihedral angle of the body) and `in_mesh` (0: the mesh lacks it, and
/// the line is the curve of the body). Points have `vertex`, the vertex of mesh.vtu, -1 for none.
/// @param shift  from working to model coordinates
/// \throw std::system_error  names the file
void write_features(const std::filesystem::path& file, const PiecewiseMesh& mesh, const Vec3& shift);

}  // namespace umtet
