#pragma once

#include <algorithm>
#include <array>
#include <bit>

namespace umtet::detail {

/// Writes a number at `at` in little-endian order, and advances `at`.
template <class T>
void put(char*& at, T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  at = std::copy(bytes.begin(), bytes.end(), at);
}

}  // namespace umtet::detail
