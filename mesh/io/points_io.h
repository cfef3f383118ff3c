#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// Points with named data.
struct PointFile {
  std::vector<Vec3> points;
  std::map<std::string, FieldValues> point_data;  ///< one value per point
};

/// Reads the points of a .vtp that write_vtp() wrote, with their data: floats as double, unsigned bytes unchanged,
/// other integers as 64 bits. Lines and polygons are skipped. \throw std::system_error if the file cannot be read,
/// MeshFileRefused for invalid content
PointFile read_points(const std::filesystem::path& path);

}  // namespace umtet
