#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace umtet {

/// Where everything is in the file that write_vtu() makes, for those who write a part of it each. Its
/// arrays are base64 text of a header of eight bytes, which holds the number of the others, and of these.
struct VtuShape {
  struct Array {
    std::string name;
    std::uint64_t begin = 0;    ///< of its text in the file
    std::uint64_t n_bytes = 0;  ///< of its values
    std::uint64_t n_encoded() const { return 8 + n_bytes; }
  };
  std::vector<std::pair<std::uint64_t, std::string>> texts;  ///< and where they begin: all that is between arrays
  std::vector<Array> arrays;  ///< fields of points, of tets, then Points, connectivity, offsets, types
  bool has_wide_ids = false;  ///< connectivity and offsets are of 64 bits, not of 32
};

/// One number for each vertex or tet, or three.
struct VtuField {
  enum class Type { Float64, Int64, UInt8, ThreeFloat64 };
  std::string name;
  Type type;
};

/// @param point_fields, cell_fields  ascending by name
/// @param nodes_per_tet  4, or 10 of second order
VtuShape vtu_shape(std::size_t n_points, std::size_t n_tets, const std::vector<VtuField>& point_fields,
                   const std::vector<VtuField>& cell_fields, std::size_t nodes_per_tet = 4);

/// @return 4 characters for each 3 bytes, and for what is left of them
std::string base64(const unsigned char* bytes, std::size_t n);

}  // namespace umtet
