#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace umtet::detail {

/// Separators of a table of numbers in text.
struct TextDialect {
  enum class Between {
    Blanks,  ///< runs of blanks and tabs
    Comma,   ///< one comma between two columns, which may be empty
    Semicolon,
    Mixed  ///< runs of blanks, tabs and commas
  };
  Between between = Between::Blanks;
  bool decimal_comma = false;  ///< "0,25" is a quarter; a comma then does not separate columns
  char end_of_line = '\n';     ///< '\n', or '\r' if no line ends otherwise
};

/// Detects the dialect from most lines; lines that do not begin like a number count only if no line does. A comma
/// between two digits is a decimal comma if blanks or semicolons separate the columns and no number contains a point.
/// @param lines  not blank, without comments
TextDialect dialect_of(const std::vector<std::string_view>& lines, char end_of_line);

/// Splits a line into columns, without surrounding blanks and quotes; only Comma and Semicolon allow empty ones.
void split(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& columns);

/// Parses a number in C syntax, independent of the locale; with decimal_comma no number contains a point.
/// @return false if `token` is not a number, or beyond the range of double precision
bool parse_number(std::string_view token, const TextDialect& dialect, double& number);

/// True if the column states that nothing was measured: it is empty, or NA, N/A, null, none or "-", in any case.
bool is_missing(std::string_view token);

}  // namespace umtet::detail
