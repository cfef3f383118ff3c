#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace umtet::detail {

/// Storage type of a number.
struct NumberType {
  enum class Kind { Signed, Unsigned, Float };
  Kind kind;
  int bytes;  ///< 1, 2, 4 or 8
};

/// Storage type for a name in VTK's XML files: Int8, UInt8 ... UInt64, Float32, Float64.
std::optional<NumberType> xml_number_type(std::string_view name);

/// Appends the numbers stored in some bytes. @param swap  reverses the bytes of each number
void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<double>& out);
/// Appends them without rounding; a float loses its fraction.
void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<std::int64_t>& out);

}  // namespace umtet::detail
