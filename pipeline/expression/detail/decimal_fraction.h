#pragma once

#include <ginac/ginac.h>

#include <cstddef>
#include <string>

namespace umtet {

/// How many characters at the start of a text are an unsigned decimal number: 12, .5, 1.e-3. 0 if there is none.
std::size_t length_of_decimal(const char* text);

/// The fraction that such a number stands for, exactly: .1 is a tenth.
/// \throw std::out_of_range  beyond 1e308 or below 1e-307, or more than 300 digits from the first that is not 0
GiNaC::numeric fraction_of_decimal(const std::string& number);

}  // namespace umtet
