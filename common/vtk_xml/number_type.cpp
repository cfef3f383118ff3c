#include "common/vtk_xml/number_type.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

namespace umtet::detail {
namespace {

template <class To, class From>
To as(From value) {
  if constexpr (std::is_floating_point_v<From> && std::is_integral_v<To>) {
    return std::abs(value) < From(9e18) ? static_cast<To>(value) : To(0);  // NaN too
  } else {
    return static_cast<To>(value);
  }
}

template <class T, class To>
void append_as(std::string_view bytes, bool swap, std::vector<To>& out) {
  const std::size_t n = bytes.size() / sizeof(T), before = out.size();
  out.resize(before + n);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes.data() + i * sizeof(T), sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    out[before + i] = as<To>(std::bit_cast<T>(raw));
  }
}

template <class To>
void append(std::string_view bytes, NumberType type, bool swap, std::vector<To>& out) {
  using Kind = NumberType::Kind;
  if (type.kind == Kind::Float) {
    return type.bytes == 4 ? append_as<float>(bytes, swap, out) : append_as<double>(bytes, swap, out);
  }
  const bool has_sign = type.kind == Kind::Signed;
  switch (type.bytes) {
    case 1:
      return has_sign ? append_as<std::int8_t>(bytes, swap, out) : append_as<std::uint8_t>(bytes, swap, out);
    case 2:
      return has_sign ? append_as<std::int16_t>(bytes, swap, out) : append_as<std::uint16_t>(bytes, swap, out);
    case 4:
      return has_sign ? append_as<std::int32_t>(bytes, swap, out) : append_as<std::uint32_t>(bytes, swap, out);
    default:
      return has_sign ? append_as<std::int64_t>(bytes, swap, out) : append_as<std::uint64_t>(bytes, swap, out);
  }
}

}  // namespace

std::optional<NumberType> xml_number_type(std::string_view name) {
  using Kind = NumberType::Kind;
  static constexpr std::array<std::pair<std::string_view, NumberType>, 10> kTypes = {{{"Int8", {Kind::Signed, 1}},
                                                                                      {"UInt8", {Kind::Unsigned, 1}},
                                                                                      {"Int16", {Kind::Signed, 2}},
                                                                                      {"UInt16", {Kind::Unsigned, 2}},
                                                                                      {"Int32", {Kind::Signed, 4}},
                                                                                      {"UInt32", {Kind::Unsigned, 4}},
                                                                                      {"Int64", {Kind::Signed, 8}},
                                                                                      {"UInt64", {Kind::Unsigned, 8}},
                                                                                      {"Float32", {Kind::Float, 4}},
                                                                                      {"Float64", {Kind::Float, 8}}}};
  for (const auto& [known, type] : kTypes)
    if (known == name) return type;
  return std::nullopt;
}

void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<double>& out) {
  append(bytes, type, swap, out);
}

void append_numbers(std::string_view bytes, NumberType type, bool swap, std::vector<std::int64_t>& out) {
  append(bytes, type, swap, out);
}

}  // namespace umtet::detail
