#include "pipeline/expression/detail/decimal_fraction.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace umtet {
namespace {

constexpr long kMostDecades = 308;
constexpr long kLeastDecades = -307;
constexpr std::size_t kMostDigits = 300;
constexpr std::size_t kMostExponent = 6;  // characters

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::size_t n_digits(const char* s) {
  std::size_t n = 0;
  while (is_digit(s[n])) ++n;
  return n;
}

}  // namespace

std::size_t length_of_decimal(const char* s) {
  std::size_t n = n_digits(s);
  const bool begins_with_digits = n > 0;
  if (s[n] == '.') ++n;
  const std::size_t after_point = n_digits(s + n);
  if (!begins_with_digits && after_point == 0) return 0;
  n += after_point;
  if (s[n] != 'e' && s[n] != 'E') return n;
  const std::size_t sign = s[n + 1] == '+' || s[n + 1] == '-' ? 1 : 0;
  const std::size_t exponent = n_digits(s + n + 1 + sign);
  return exponent > 0 ? n + 1 + sign + exponent : n;
}

GiNaC::numeric fraction_of_decimal(const std::string& number) {
  const std::size_t e = std::min(number.find_first_of("eE"), number.size());
  const std::size_t point = std::min(number.find('.'), e);
  std::string mantissa = number.substr(0, point);
  long exponent = 0;
  if (point < e) {
    mantissa += number.substr(point + 1, e - point - 1);
    exponent -= static_cast<long>(e - point - 1);
  }
  if (e < number.size()) {
    const std::string given = number.substr(e + 1);
    if (given.size() > kMostExponent) throw std::out_of_range(number);
    exponent += std::stol(given);
  }
  // GiNaC would read a number with leading zeros as octal.
  const std::size_t first = mantissa.find_first_not_of('0');
  if (first == std::string::npos) return 0;
  mantissa.erase(0, first);
  const long decades = static_cast<long>(mantissa.size()) + exponent;
  if (decades > kMostDecades || decades < kLeastDecades || mantissa.size() > kMostDigits) {
    throw std::out_of_range(number);
  }
  return GiNaC::numeric(mantissa.c_str()) * GiNaC::pow(GiNaC::numeric(10), GiNaC::numeric(exponent));
}

}  // namespace umtet
