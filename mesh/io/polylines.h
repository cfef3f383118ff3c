#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// Writes lines through points, with one value for each line and each point, as VTK XML polydata; encoding as in
/// write_vtu().
/// @param lines  the points of each line, in order
/// \throw std::invalid_argument for data of the wrong size or a point that does not exist, std::system_error naming the
///        path if writing fails
void write_polylines(const std::filesystem::path& path, const std::vector<Vec3>& points,
                     const std::vector<std::vector<int>>& lines, const std::map<std::string, FieldValues>& point_data,
                     const std::map<std::string, FieldValues>& line_data);

}  // namespace umtet
