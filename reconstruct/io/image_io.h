#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Numbers at the nodes of a grid, x fastest.
struct Image {
  Eigen::Vector3i n;
  Vec3 origin, spacing;
  /// Arrays by name, with one number per node; viewers show the first array.
  std::vector<std::pair<std::string, std::vector<float>>> values;
};

/// Writes VTK ImageData (.vti) with raw appended data.
/// \throw std::invalid_argument if there are no arrays, or an array does not have one number per node
/// \throw std::system_error naming the path if the file is incomplete
void write_image(const std::filesystem::path& file, const Image& image);

}  // namespace umtet
