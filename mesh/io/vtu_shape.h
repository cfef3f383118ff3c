#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace umtet {

/// Layout of the file that write_vtu() makes, for processes that write a part of it each. Its arrays are base64 text of
/// an eight-byte header, which contains the number of value bytes, and of the values.
struct VtuShape {
  struct Array {
    std::string name;
    std::uint64_t begin = 0;    ///< position of its text in the file
    std::uint64_t n_bytes = 0;  ///< size of its values
    std::uint64_t n_encoded() const { return 8 + n_bytes; }
  };
  std::vector<std::pair<std::uint64_t, std::string>> texts;  ///< positions and texts of everything between arrays
  std::vector<Array> arrays;  ///< point fields, tet fields, then Points, connectivity, offsets, types
  bool has_wide_ids = false;  ///< connectivity and offsets have 64 bits instead of 32
};

/// A field with one number, or three, per vertex or tet.
struct VtuField {
  enum class Type { Float64, Int64, UInt8, ThreeFloat64 };
  std::string name;
  Type type;
};

/// Computes the layout of a file.
/// @param point_fields, cell_fields  ascending by name
/// @param nodes_per_tet  4, or 10 for quadratic tets
VtuShape vtu_shape(std::size_t n_points, std::size_t n_tets, const std::vector<VtuField>& point_fields,
                   const std::vector<VtuField>& cell_fields, std::size_t nodes_per_tet = 4);

/// Base64 text of bytes: 4 characters for every 3 bytes, and 4 for the remainder.
std::string base64(const unsigned char* bytes, std::size_t n);

}  // namespace umtet
