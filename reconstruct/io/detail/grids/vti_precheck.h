#pragma once

#include <filesystem>

namespace umtet::detail {

/// Reads the XML of a level set and its blocks before VTK does: VTK 9.1 follows a null pointer for an array of unknown
/// type, allocates what a tag announces, and leaves the rest of an array as it was where a block is short.
///
/// Only what write_level_set() writes passes: its elements in their places, inline blocks of Float64 and Float32 as
/// long as they say, and in PointData one number a node. \throw LevelSetRefused  with byte and reason
void precheck_vti(const std::filesystem::path& path);

}  // namespace umtet::detail
