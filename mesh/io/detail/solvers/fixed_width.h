#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace umtet::detail {

/// Checks that a number fits into a field. @param file  the file in the text of the error
/// \throw std::invalid_argument for a number with more than `width` digits
inline void require_width(std::size_t number, int width, std::string_view file) {
  const std::string largest(static_cast<std::size_t>(width), '9');
  if (number > std::stoull(largest)) {
    throw std::invalid_argument(std::string(file) + " with a number beyond " + largest);
  }
}

/// A number formatted for a text field of fixed width: the shortest text that reads back to the same value if it fits,
/// else as many digits as fit.
class FixedWidth {
 public:
  enum class Style {
    C,        ///< 1e-05
    Nastran,  ///< 1.E-5: a real number contains a point
  };
  /// @param width  12..24
  FixedWidth(double value, int width, Style style) {
    set(std::to_chars(digits_.data(), digits_.data() + digits_.size(), value).ptr, style);
    for (int precision = 17; size_ > width; --precision) {
      set(std::to_chars(digits_.data(), digits_.data() + digits_.size(), value, std::chars_format::general, precision)
              .ptr,
          style);
    }
  }
  std::string_view text() const { return {digits_.data(), static_cast<std::size_t>(size_)}; }

 private:
  void set(const char* end, Style style) {
    size_ = static_cast<int>(end - digits_.data());
    if (style == Style::C) return;
    std::array<char, 32> out;
    int n = 0;
    bool point = false, exponent = false;
    for (int k = 0; k < size_; ++k) {
      const char c = digits_[k];
      if (c == '.') point = true;
      if (c == 'e') {
        exponent = true;
        if (!point) out[n++] = '.';
        out[n++] = 'E';
        out[n++] = digits_[++k];                             // sign of the exponent
        while (digits_[k + 1] == '0' && k + 2 < size_) ++k;  // "E-05" wastes a digit
        continue;
      }
      out[n++] = c;
    }
    if (!point && !exponent) out[n++] = '.';
    digits_ = out;
    size_ = n;
  }

  std::array<char, 32> digits_;
  int size_ = 0;
};

/// A number in 21 characters as Fortran writes it with 1p,e21.13e3: 14 digits, and an exponent of three digits.
class FortranReal {
 public:
  explicit FortranReal(double value) {
    std::array<char, 32> digits;
    const char* const begin = digits.data();
    // The sum turns -0 into 0.
    const char* const end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value + 0., std::chars_format::scientific, 13).ptr;
    const char* const exponent = std::find(begin, end, 'e');  // of two or three digits; none in inf and nan
    text_.fill(' ');
    char* out = text_.data() + text_.size();
    if (exponent != end) {
      out = std::copy_backward(exponent + 2, end, out);
      if (end - exponent == 4) *--out = '0';
      *--out = exponent[1];  // the sign
      *--out = 'E';
    }
    std::copy_backward(begin, exponent, out);
  }
  std::string_view text() const { return {text_.data(), text_.size()}; }

 private:
  std::array<char, 21> text_;
};

}  // namespace umtet::detail
