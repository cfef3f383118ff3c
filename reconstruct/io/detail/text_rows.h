#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Walks over the lines of a file; LF and CRLF end a line, the end of the file too.
class LineReader {
 public:
  /// @param first_line  number of the line at `offset`, counted from 1
  /// @param end         ends a line instead of LF
  LineReader(std::string_view bytes, std::size_t offset = 0, std::size_t first_line = 1, char end = '\n')
      : bytes_(bytes), next_(offset), line_(first_line - 1), end_(end) {}

  /// The next line without its end; false at the end of the file.
  bool next(std::string_view& line);
  /// The next line that is not blank.
  bool next_filled(std::string_view& line);

  std::size_t line() const { return line_; }    ///< number of the line last returned, from 1
  std::size_t offset() const { return next_; }  ///< byte after it

 private:
  std::string_view bytes_;
  std::size_t next_;
  std::size_t line_;
  char end_;
};

/// The parts of `line` between runs of separators.
void split(std::string_view line, std::string_view separators, std::vector<std::string_view>& tokens);

/// A whole number >= 0 and nothing else.
std::optional<std::uint64_t> parse_count(std::string_view token);

/// A number as C writes it, whatever the locale; nan and inf are numbers here, refused later with the point's number.
/// \throw CloudRefused  names the line, and the decimal comma if that is what it is
double parse_number(const CloudSource& source, std::size_t line, std::string_view token);

/// The same of something that a cloud can be read without: NaN for what is no number.
double number_or_nan(std::string_view token);

}  // namespace umtet::detail
