#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace umtet::detail {

/// Numbers of sample rows spread over a whole table; NaN where there is no number.
struct SampleRows {
  std::size_t n_columns = 0;
  std::vector<double> values;  ///< n_columns per row
  std::size_t n_first = 0;     ///< number of first rows that are consecutive in the table

  std::size_t n_rows() const { return n_columns > 0 ? values.size() / n_columns : 0; }
  double at(std::size_t row, std::size_t column) const { return values[row * n_columns + column]; }
};

/// Meaning of the columns of a text.
struct TextColumns {
  /// One name per column, for cloud_columns(): x, y, z, nx, ny, nz, red, green, blue, label, or the name of a field;
  /// empty for a column that is dropped.
  std::vector<std::string> names;
  double bytes_per_unit = 1;  ///< factor from a colour's value to 0..255
  /// This column becomes the label if it contains whole numbers with few different values; -1: there is none.
  std::size_t perhaps_label = static_cast<std::size_t>(-1);
  std::string how;           ///< source of the names: "guessed from their values"
  bool are_guessed = false;  ///< from their values
  std::string problem;  ///< reason why the columns are unknown; else empty
};

/// Description of the columns for the user, in one line: "columns x y z - nx ny nz, guessed from their values".
std::string told(const TextColumns& columns);

/// Maps the name of a column in a header, in any case, to the name that cloud_columns() uses. Names of axes include
/// "Points:0", "pos_x", "Easting" and the like, without a unit in brackets; "r" is red. The result is empty for a
/// column that numbers the rows ("id", "index", no name). Other names are unchanged.
std::string column_name(std::string_view in_header);

/// True if x, y and z are among the names. @param names  results of column_name()
bool has_axes(const std::vector<std::string>& names);

/// Columns with names. The rows determine how colours are scaled and which columns contain no numbers.
/// @param names  results of column_name(), one per column; for the argument `columns` possibly fewer, then the others are
///               dropped
/// @param how    source of the names: "as the header says"
TextColumns columns_by_name(std::vector<std::string> names, const SampleRows& rows, std::string_view how);

/// Guesses the meaning of columns without names:
/// - The first three columns with numbers are x, y, z; a first column that counts the rows is dropped.
/// - Three more in a row are the normal if they are vectors of equal length with both signs. They are colours if all
///   numbers are whole and within 0..255 (or 0..65535), or within 0..1.
/// - The remaining columns are fields: a single one is the intensity, or the label (TextColumns::perhaps_label), and
///   two are named by their positions. More than two are a problem.
///
/// @param extension  ".xyzn" and ".npts" define six columns, and so does ".xyzrgb"; in ".pts" an intensity precedes the
///                   colours
TextColumns columns_by_value(const SampleRows& rows, std::string_view extension);

/// The words of the argument `columns`, mapped by column_name(); "-" and "skip" drop a column.
std::vector<std::string> told_columns(std::string_view columns);

}  // namespace umtet::detail
