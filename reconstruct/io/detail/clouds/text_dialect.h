#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace umtet::detail {

/// How the columns of a table stand in its lines.
struct TextDialect {
  enum class Between {
    Blanks,  ///< runs of blanks and tabs
    Comma,   ///< one comma between two columns, which may be empty
    Semicolon,
    Mixed  ///< runs of blanks, tabs and commas
  };
  Between between = Between::Blanks;
  bool decimal_comma = false;  ///< "0,25" is a quarter; then no comma separates columns
  char end_of_line = '\n';     ///< or '\r', where no line ends otherwise
};

/// The dialect of most lines; lines that do not begin like a number count only if no line does. A comma between two
/// digits is a decimal comma where blanks or semicolons separate the columns and no number has a point.
/// @param lines  not blank, without comments
TextDialect dialect_of(const std::vector<std::string_view>& lines, char end_of_line);

/// The columns of a line, without blanks and quotes around them; empty ones only with Comma and Semicolon.
void split(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& columns);

/// A number as C writes it, whatever the locale; with decimal_comma no number has a point.
/// @return false: `token` is no number, or beyond the range of double precision
bool parse_number(std::string_view token, const TextDialect& dialect, double& number);

/// @return the column says that nothing was measured: it is empty, or NA, N/A, null, none or "-", in any case
bool is_missing(std::string_view token);

}  // namespace umtet::detail
