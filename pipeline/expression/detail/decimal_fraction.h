#pragma once

#include <ginac/ginac.h>

#include <cstddef>
#include <string>

namespace umtet {

/// Returns the length of the unsigned decimal number at the start of a text, such as 12, .5, 1.e-3; 0 if there is none.
std::size_t length_of_decimal(const char* text);

/// Returns the exact fraction that such a number represents: .1 is a tenth.
/// \throw std::out_of_range  beyond 1e308 or below 1e-307, or more than 300 digits after leading zeros
GiNaC::numeric fraction_of_decimal(const std::string& number);

}  // namespace umtet
