#pragma once

#include <cstdint>
#include <filesystem>

namespace umtet::detail {

/// Looks at the tags of a .vtu before VTK does, which believes every count it reads.
///
/// Checked: the root is a VTKFile of type UnstructuredGrid; tags nest and the file is not cut; numbers of points,
/// cells, tuples and components are plain numbers that the bytes of the file can hold (compressed blocks counted at
/// zlib's greatest ratio); every inline binary block is base64 of the length its header says, and parts of compressed
/// ones have a size, in appended data too, which begin with their underscore; attributes are name="value" without
/// references to characters; no polyhedra, whose face lists VTK follows blindly.
///
/// @return  the most values that an array of this file can have
/// \throw std::system_error when the file cannot be read, MeshFileRefused for its content
std::uint64_t precheck_vtu(const std::filesystem::path& path);

}  // namespace umtet::detail
