#pragma once

#include <cstddef>
#include <span>

namespace umtet::detail {

/// Length of n bytes in base64, including padding (RFC 4648, Section 4).
constexpr std::size_t base64_length(std::size_t n) { return (n + 2) / 3 * 4; }

/// Encodes bytes as base64_length(bytes.size()) characters.
void encode_base64(std::span<const unsigned char> bytes, char* text);

}  // namespace umtet::detail
