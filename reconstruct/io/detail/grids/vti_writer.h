#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/vec3.h"
#include "common/vtk_xml/appended_writer.h"

namespace umtet::detail {

/// The nodes of a VTK ImageData.
struct ImageNodes {
  Eigen::Vector3i n;
  Vec3 origin, spacing;
};

/// Writes the beginning of a .vti: the grid and the start of the field data.
void begin_image(AppendedWriter& out, const ImageNodes& nodes);
/// Ends the field data and begins the point data. @param scalars  the array that viewers show first
void begin_point_data(AppendedWriter& out, const ImageNodes& nodes, const std::string& scalars);
/// Ends the point data and writes the file. \throw std::system_error naming the path if the file is incomplete
void write_image(const std::filesystem::path& path, AppendedWriter& out);

}  // namespace umtet::detail
