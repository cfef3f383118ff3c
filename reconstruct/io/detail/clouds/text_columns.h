#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace umtet::detail {

/// Numbers of some rows of a table, NaN where there is none; spread over the whole of it.
struct SampleRows {
  std::size_t n_columns = 0;
  std::vector<double> values;  ///< n_columns a row
  std::size_t n_first = 0;     ///< so many rows from the first on have no other between them

  std::size_t n_rows() const { return n_columns > 0 ? values.size() / n_columns : 0; }
  double at(std::size_t row, std::size_t column) const { return values[row * n_columns + column]; }
};

/// The meaning of the columns of a text.
struct TextColumns {
  /// One a column, as cloud_columns() takes them: x, y, z, nx, ny, nz, red, green, blue, label, or the name of a field;
  /// empty for a column that is left out.
  std::vector<std::string> names;
  double bytes_per_unit = 1;  ///< a colour's value times this is 0..255
  /// This column becomes the label if it holds whole numbers, of which few are different; n: there is none such.
  std::size_t perhaps_label = static_cast<std::size_t>(-1);
  std::string how;      ///< the names are known: "guessed from their values"
  std::string problem;  ///< that makes the columns unknown; or empty
};

/// "columns x y z - nx ny nz, guessed from their values": for the user, in one line.
std::string told(const TextColumns& columns);

/// The name that cloud_columns() knows for what a header calls a column, in any case: of the axes also "Points:0",
/// "pos_x", "Easting" and the like, without a unit in brackets; "r" is red. Empty for what numbers the rows ("id",
/// "index", no name). Other names stay as they are.
std::string column_name(std::string_view in_header);

/// @return x, y and z are among the names. @param names  of column_name()
bool has_axes(const std::vector<std::string>& names);

/// Columns with names. The rows tell how colours are scaled and which columns hold no numbers.
/// @param names  of column_name(), one a column; of --columns also fewer, then the others are left out
/// @param how  who gives the names: "as the header says"
TextColumns columns_by_name(std::vector<std::string> names, const SampleRows& rows, std::string_view how);

/// Columns without names. The first three with numbers are x, y, z; a first column that counts the rows is left out.
/// Three more in a row are the normal if they are vectors of one length with both signs. They are colours if all
/// numbers are whole and within 0..255 (or 0..65535), or within 0..1. The remaining columns are fields: a single one is
/// the intensity, or the label (TextColumns::perhaps_label), and two have the names of their places. More than two are
/// a problem.
/// @param extension  ".xyzn" and ".npts" name six columns, ".xyzrgb" too; of ".pts" an intensity is before the colours
TextColumns columns_by_value(const SampleRows& rows, std::string_view extension);

/// The words of --columns, of column_name(); "-" and "skip" leave a column out.
std::vector<std::string> told_columns(std::string_view columns);

}  // namespace umtet::detail
