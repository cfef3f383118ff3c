#pragma once

#include <cstdint>
#include <filesystem>

namespace umtet::detail {

/// Validates the tags of a .vtu file before VTK parses it, because VTK trusts every count it reads. Checks:
/// - The root is a VTKFile of type UnstructuredGrid; tags nest, and the file is complete.
/// - Numbers of points, cells, tuples and components are plain numbers that the bytes of the file can hold (compressed
///   blocks are counted at zlib's maximum ratio).
/// - Every inline binary block is base64 with the length that its header states.
/// - Parts of compressed blocks have a size, also in appended data, which begin with their underscore.
/// - Attributes are name="value" without character references.
/// - There are no polyhedra, whose face lists VTK follows without checks.
///
/// @return  upper bound on the number of values in any array of this file
/// \throw std::system_error if the file cannot be read, MeshFileRefused for invalid content
std::uint64_t precheck_vtu(const std::filesystem::path& path);

}  // namespace umtet::detail
