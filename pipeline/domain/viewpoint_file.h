#pragma once

#include <filesystem>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Points of a text with three numbers a line; '#' begins a comment.
/// \throw CloudRefused  a line that is no point, or no point at all; std::system_error
std::vector<Vec3> read_viewpoints(const std::filesystem::path& file);

}  // namespace umtet
