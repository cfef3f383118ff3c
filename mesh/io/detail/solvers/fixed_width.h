#pragma once

#include <array>
#include <charconv>
#include <string_view>

namespace umtet::detail {

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

}  // namespace umtet::detail
