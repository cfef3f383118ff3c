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

/// A longer line is no row: of a damaged or binary file a line may be gigabytes.
inline constexpr std::size_t kLongestLine = 1 << 16;

/// The beginning of a table of numbers in a text, and the lines before it.
struct TextTable {
  TextDialect dialect;
  std::size_t begin = 0;                   ///< byte of the first row
  std::size_t first_line = 1;              ///< its number, from 1
  std::size_t n_columns = 0;               ///< of each row
  std::optional<std::uint64_t> announced;  ///< the number of points, where a line before the rows is that number
  std::vector<std::string> header;         ///< column_name() of each column, x, y and z among them; or empty
  std::size_t n_ignored = 0;               ///< lines of words before the rows that are no such header
};

/// \throw CloudRefused  the text does not begin with a table of three or more columns of numbers: names line and column
TextTable find_table(const CloudSource& source);

/// @return the text begins with such a table, and has no other words before it than a header; this is asked about files
/// with the extension of no format
bool is_table(const CloudSource& source);

/// @return the line is a comment
bool is_comment(std::string_view line);

/// Splits a line of the table. A comment behind the last column, and a separator without a column behind it, are left
/// out. @return the number of columns, n_columns if the line is a row
std::size_t split_row(std::string_view line, const TextTable& table, std::vector<std::string_view>& columns);

/// Rows from all over the table, some thousand at most: those at its beginning, and then some at places that are evenly
/// spread. Lines that are no rows are left out.
SampleRows sample_rows(const CloudSource& source, const TextTable& table);

}  // namespace umtet::detail
