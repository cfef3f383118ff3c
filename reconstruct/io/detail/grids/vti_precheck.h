#pragma once

#include <filesystem>

namespace umtet::detail {

/// Validates the XML of a level set and its blocks before VTK parses it. VTK 9.1 follows a null pointer for an array of
/// unknown type, allocates what a tag announces, and leaves the rest of an array unchanged if a block is short.
///
/// Only files as written by write_level_set() pass: elements at their positions, inline blocks of Float64 and Float32
/// of the stated length, and one number per node in PointData. \throw LevelSetRefused with byte and reason
void precheck_vti(const std::filesystem::path& path);

}  // namespace umtet::detail
