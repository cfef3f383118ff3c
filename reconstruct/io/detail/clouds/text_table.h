#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/clouds/text_columns.h"
#include "reconstruct/io/detail/clouds/text_dialect.h"

namespace umtet::detail {

/// Maximum length of a row: a line of a damaged or binary file may have gigabytes.
inline constexpr std::size_t kLongestLine = 1 << 16;

/// The beginning of a table of numbers in a text, with the lines before it.
struct TextTable {
  TextDialect dialect;
  std::size_t begin = 0;                   ///< position of the first row in the file
  std::size_t first_line = 1;              ///< line number of the first row, from 1
  std::size_t n_columns = 0;               ///< columns of each row
  std::optional<std::uint64_t> announced;  ///< the number of points, if a line before the rows contains it
  std::vector<std::string> header;         ///< column_name() of each column, including x, y and z; or empty
  std::size_t n_ignored = 0;               ///< lines of words before the rows that are not such a header
};

/// Finds the table. \throw CloudRefused with line and column, if the text does not begin with a table of three or more
/// columns of numbers
TextTable find_table(const CloudSource& source);

/// True if the text begins with such a table, preceded by no words but a header. It is used for files whose extension
/// belongs to no format.
bool is_table(const CloudSource& source);

/// True if the line is a comment.
bool is_comment(std::string_view line);

/// Splits a line of the table. A comment after the last column, and a separator without a column after it, are ignored.
/// @return the number of columns; n_columns if the line is a row
std::size_t split_row(std::string_view line, const TextTable& table, std::vector<std::string_view>& columns);

/// Sample rows from the whole table, some thousand at most: those at its beginning, then others at evenly spread
/// positions. Lines that are not rows are skipped.
SampleRows sample_rows(const CloudSource& source, const TextTable& table);

}  // namespace umtet::detail
