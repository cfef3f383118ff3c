#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace umtet {

/// Layout of the file that write_vtu() makes, for processes that write a part of it each. Its arrays are raw bytes.
struct VtuShape {
  struct Array {
    std::string name;
    std::uint64_t begin = 0;    ///< position of its values in the file
    std::uint64_t n_bytes = 0;  ///< size of its values
  };
  std::vector<std::pair<std::uint64_t, std::string>> texts;  ///< positions and texts of everything outside the arrays
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

}  // namespace umtet
