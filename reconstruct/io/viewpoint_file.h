#pragma once

#include <filesystem>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Reads points from a text with three numbers per line; '#' begins a comment.
/// \throw CloudRefused  a line is not a point, or there is no point; std::system_error
std::vector<Vec3> read_viewpoints(const std::filesystem::path& file);

}  // namespace umtet
