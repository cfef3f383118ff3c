#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Reads the lines of a file. LF, CRLF and the end of the file end a line.
class LineReader {
 public:
  /// @param first_line  number of the line at `offset`, counted from 1
  /// @param end         line separator in place of LF
  LineReader(std::string_view bytes, std::size_t offset = 0, std::size_t first_line = 1, char end = '\n')
      : bytes_(bytes), next_(offset), line_(first_line - 1), end_(end) {}

  /// The next line without its end; false at the end of the file.
  bool next(std::string_view& line);
  /// The next line that is not blank.
  bool next_filled(std::string_view& line);

  std::size_t line() const { return line_; }    ///< number of the line last returned, from 1
  std::size_t offset() const { return next_; }  ///< position after this line

 private:
  std::string_view bytes_;
  std::size_t next_;
  std::size_t line_;
  char end_;
};

/// The parts of `line` between runs of separators.
void split(std::string_view line, std::string_view separators, std::vector<std::string_view>& tokens);

/// Parses a whole number >= 0; nothing else may follow.
std::optional<std::uint64_t> parse_count(std::string_view token);

/// Parses a number in C syntax, independent of the locale. nan and inf are accepted here, and rejected later with the
/// number of the point.
/// \throw CloudRefused with the line, and with a hint if there is a decimal comma
double parse_number(const CloudSource& source, std::size_t line, std::string_view token);

/// The same for data that a cloud can be read without: NaN for anything that is not a number.
double number_or_nan(std::string_view token);

}  // namespace umtet::detail
