#include "reconstruct/io/detail/clouds/text_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/clouds/field_columns.h"
#include "reconstruct/io/detail/clouds/text_dialect.h"

namespace umtet::detail {
namespace {

// Rounding to one decimal changes the length of a unit vector by up to .05 sqrt(3) = .087.
constexpr double kOneLength = .1;
// The share of rows that have normals of one length; the other normals of a scan may be damaged.
constexpr double kMostRows = .9;
constexpr double kByte = 255, kSixteenBits = 65535;
// Three columns that are left may be a vector, such as a normal, whose meaning must not be lost.
constexpr std::size_t kMostScalars = 2;

// Characters of names in a line for the user.
constexpr std::size_t kMostNames = 100;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

/// Properties of the numbers of a column, in the rows of a sample.
struct ColumnValues {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool whole = true;
  std::size_t n = 0;  ///< numbers that are finite

  bool is_constant() const { return low == high; }
};

ColumnValues values_of(const SampleRows& rows, std::size_t column) {
  ColumnValues values;
  for (std::size_t r = 0; r < rows.n_rows(); ++r) {
    const double v = rows.at(r, column);
    if (!std::isfinite(v)) continue;
    values.low = std::min(values.low, v), values.high = std::max(values.high, v);
    values.whole &= v == std::trunc(v);
    ++values.n;
  }
  return values;
}

std::array<ColumnValues, 3> values_of_three(const SampleRows& rows, std::size_t column) {
  return {values_of(rows, column), values_of(rows, column + 1), values_of(rows, column + 2)};
}

/// @return a colour's value times this is 0..255; 0: the columns hold no colours
double bytes_per_unit(const std::array<ColumnValues, 3>& rgb) {
  double low = 0, high = 0;
  bool whole = true, all_large = true;
  for (const ColumnValues& c : rgb) {
    if (c.n == 0) return 0;
    low = std::min(low, c.low), high = std::max(high, c.high);
    whole &= c.whole, all_large &= c.high > kByte;
  }
  if (low < 0) return 0;
  if (high <= 1) return kByte;
  if (!whole) return 0;
  if (high <= kByte) return 1;
  return high <= kSixteenBits && all_large ? kByte / kSixteenBits : 0;
}

/// Vectors of one length that point to more than one side. Colours have no signs.
bool are_normals(const SampleRows& rows, std::size_t column) {
  std::vector<double> lengths;
  bool has_negative = false;
  for (std::size_t r = 0; r < rows.n_rows(); ++r) {
    const double x = rows.at(r, column), y = rows.at(r, column + 1), z = rows.at(r, column + 2);
    const double length = std::hypot(x, y, z);
    if (!std::isfinite(length) || length == 0) continue;  // a normal that is missing
    lengths.push_back(length);
    has_negative |= std::min({x, y, z}) < 0;
  }
  if (lengths.empty()) return false;
  const auto three = values_of_three(rows, column);
  if (std::all_of(three.begin(), three.end(), [](const ColumnValues& c) { return c.is_constant(); })) return false;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double length = *middle;
  const auto n_same = std::count_if(lengths.begin(), lengths.end(),
                                    [&](double l) { return std::abs(l - length) <= kOneLength * length; });
  if (static_cast<double>(n_same) < kMostRows * static_cast<double>(lengths.size())) return false;
  // A sheet that looks to one octant has no signs either; its normals are unit and no whole numbers.
  const bool whole = std::all_of(three.begin(), three.end(), [](const ColumnValues& c) { return c.whole; });
  return has_negative || (!whole && std::abs(length - 1) <= kOneLength);
}

bool are_zero(const SampleRows& rows, std::size_t column) {
  const auto three = values_of_three(rows, column);
  return std::all_of(three.begin(), three.end(), [](const ColumnValues& c) { return c.low == 0 && c.high == 0; });
}

/// 1, 2, 3 ... or 0, 1, 2 ..., whatever rows are between those of the sample.
bool counts_rows(const SampleRows& rows, std::size_t column) {
  constexpr std::size_t kFewest = 10;  // fewer consecutive numbers are coordinates by accident
  if (rows.n_rows() < kFewest || (rows.at(0, column) != 0 && rows.at(0, column) != 1)) return false;
  for (std::size_t r = 1; r < rows.n_rows(); ++r) {
    const double step = rows.at(r, column) - rows.at(r - 1, column);
    if (r < rows.n_first ? step != 1 : !(step >= 1 && step == std::trunc(step))) return false;
  }
  return true;
}

std::string_view scale_told(double bytes) {
  return bytes == 1 ? "" : bytes > 1 ? "; colours are 0 to 1" : "; colours have 16 bits";
}

/// Names of columns without a header, from left to right.
class Guess {
 public:
  Guess(const SampleRows& rows, std::string_view extension) : rows_(rows), extension_(extension) {
    columns_.names.resize(rows.n_columns);
  }

  TextColumns operator()() {
    std::size_t at = take_axes();
    if (at == kNone) return std::move(columns_);
    if (!take_by_extension(at)) take_others(at);
    return std::move(columns_);
  }

 private:
  std::size_t n() const { return rows_.n_columns; }
  bool is_number(std::size_t c) const { return values_of(rows_, c).n > 0; }
  bool is_pts() const { return extension_ == ".pts"; }
  void name_three(std::size_t at, const std::array<const char*, 3>& names) {
    for (std::size_t k = 0; k < 3; ++k) columns_.names[at + k] = names[k];
  }

  /// The column behind x, y, z; kNone: there are not three columns of numbers.
  std::size_t take_axes() {
    std::size_t at = 0;
    while (at < n() && !is_number(at)) ++at;
    if (at + 3 < n() && counts_rows(rows_, at)) ++at;
    if (at + 3 > n()) {
      columns_.problem = "fewer than three of them have numbers";
      return kNone;
    }
    name_three(at, {"x", "y", "z"});
    return at + 3;
  }

  bool take_by_extension(std::size_t at) {
    if (n() - at != 3) return false;
    if (extension_ == ".xyzn" || extension_ == ".npts") {
      name_three(at, {"nx", "ny", "nz"});
      return true;
    }
    if (extension_ != ".xyzrgb") return false;
    const double bytes = bytes_per_unit(values_of_three(rows_, at));
    if (bytes == 0) return false;
    take_colours(at, bytes);
    return true;
  }

  void take_colours(std::size_t at, double bytes) {
    name_three(at, {"red", "green", "blue"});
    columns_.bytes_per_unit = bytes;
  }

  /// 255, or 1, in all rows.
  bool is_opaque(std::size_t c) const {
    const ColumnValues a = values_of(rows_, c);
    return a.n > 0 && a.is_constant() && std::lround(a.high * columns_.bytes_per_unit) == std::lround(kByte);
  }

  void take_others(std::size_t at) {
    std::vector<std::size_t> scalars;
    bool has_normals = false, has_colours = false;
    while (at < n()) {
      const bool has_three = at + 3 <= n();
      const bool is_intensity = is_pts() && scalars.empty() && n() - at == 4;
      if (has_three && are_zero(rows_, at)) {
        at += 3;
      } else if (has_three && !has_normals && are_normals(rows_, at)) {
        name_three(at, {"nx", "ny", "nz"});
        has_normals = true;
        at += 3;
      } else if (const double bytes = has_three && !is_intensity ? bytes_per_unit(values_of_three(rows_, at)) : 0;
                 bytes > 0 && !has_colours) {
        take_colours(at, bytes);
        has_colours = true;
        at += 3;
        if (at < n() && is_opaque(at)) columns_.names[at++] = "alpha";
      } else {
        if (is_number(at)) scalars.push_back(at);
        ++at;
      }
    }
    name_scalars(scalars);
  }

  void name_scalars(const std::vector<std::size_t>& scalars) {
    if (scalars.size() > kMostScalars) {
      columns_.problem = fmt::format("columns {} to {} are neither normals of one length nor colours",
                                     scalars.front() + 1, scalars.back() + 1);
      return;
    }
    for (const std::size_t c : scalars) {
      columns_.names[c] = scalars.size() == 1 ? "intensity" : fmt::format("column_{}", c + 1);
    }
    const bool is_last = !scalars.empty() && scalars.back() + 1 == n();
    if (is_last && !is_pts() && values_of(rows_, n() - 1).whole) columns_.perhaps_label = n() - 1;
  }

  const SampleRows& rows_;
  std::string_view extension_;
  TextColumns columns_;
};

}  // namespace

std::string told(const TextColumns& columns) {
  std::string text = "columns";
  constexpr std::size_t kMostTold = 24;  // more do not fit into a line
  for (std::size_t c = 0; c < std::min(columns.names.size(), kMostTold); ++c) {
    const std::string name = in_quotes(columns.names[c]);
    text.append(" ").append(columns.names[c].empty() ? "-" : name.substr(1, name.size() - 2));
  }
  return text + (columns.names.size() > kMostTold ? " ..., " : ", ") + columns.how;
}

std::string column_name(std::string_view in_header) {
  const std::size_t unit = in_header.find_first_of("[(");
  if (unit != std::string_view::npos && unit > 0) in_header = in_header.substr(0, unit);
  const std::size_t end = in_header.find_last_not_of(" \t");
  in_header = in_header.substr(0, end == std::string_view::npos ? 0 : end + 1);
  std::string name(in_header);
  std::replace(name.begin(), name.end(), ' ', '_');
  const std::string key = lower(name);
  // ParaView writes "Points:0" or "Points_0", geodesists "Easting", CloudCompare "Rf" for colours from 0 to 1.
  static constexpr std::pair<const char*, std::array<const char*, 12>> kNames[] = {
      {"x",
       {"x", "points:0", "points_0", "points_x", "point_x", "pos_x", "position_x", "x_coord", "coord_x", "xcoord",
        "x_coordinate", "easting"}},
      {"y",
       {"y", "points:1", "points_1", "points_y", "point_y", "pos_y", "position_y", "y_coord", "coord_y", "ycoord",
        "y_coordinate", "northing"}},
      {"z",
       {"z", "points:2", "points_2", "points_z", "point_z", "pos_z", "position_z", "z_coord", "coord_z", "zcoord",
        "z_coordinate", "elevation"}},
      {"nx", {"nx", "normals:0", "normals_0", "normals_x", "normal_x", "normalx", "n_x", "normal:0", "xn"}},
      {"ny", {"ny", "normals:1", "normals_1", "normals_y", "normal_y", "normaly", "n_y", "normal:1", "yn"}},
      {"nz", {"nz", "normals:2", "normals_2", "normals_z", "normal_z", "normalz", "n_z", "normal:2", "zn"}},
      {"red", {"red", "r", "rf", "color_r", "colour_r", "rgb:0", "rgb_0", "diffuse_red"}},
      {"green", {"green", "g", "gf", "color_g", "colour_g", "rgb:1", "rgb_1", "diffuse_green"}},
      {"blue", {"blue", "b", "bf", "color_b", "colour_b", "rgb:2", "rgb_2", "diffuse_blue"}},
      {"alpha", {"alpha"}},
      {"", {"", "id", "index", "idx", "point_id", "pointid", "no", "nr", "#"}}};
  for (const auto& [known, others] : kNames) {
    for (const char* const other : others) {
      if (other != nullptr && key == other) return known;
    }
  }
  return is_reserved(key) ? key : name;
}

bool has_axes(const std::vector<std::string>& names) {
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  return has("x") && has("y") && has("z");
}

TextColumns columns_by_name(std::vector<std::string> names, const SampleRows& rows, std::string_view how) {
  TextColumns columns;
  names.resize(rows.n_columns);
  const auto place = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::array<std::size_t, 3> rgb = {place("red"), place("green"), place("blue")};
  if (*std::max_element(rgb.begin(), rgb.end()) < names.size()) {
    const double bytes = bytes_per_unit({values_of(rows, rgb[0]), values_of(rows, rgb[1]), values_of(rows, rgb[2])});
    columns.bytes_per_unit = bytes > 0 ? bytes : 1;
    std::replace_if(
        names.begin(), names.end(), [](const std::string& name) { return lower(name) == "a"; }, "alpha");
  }
  std::string no_numbers;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool is_axis = names[c] == "x" || names[c] == "y" || names[c] == "z";
    if (names[c].empty() || is_axis || rows.n_rows() == 0 || values_of(rows, c).n > 0) continue;
    if (no_numbers.size() < kMostNames) no_numbers.append(no_numbers.empty() ? "" : ", ").append(in_quotes(names[c]));
    names[c].clear();
  }
  columns.how = fmt::format("{}{}{}", how, scale_told(columns.bytes_per_unit),
                            no_numbers.empty() ? "" : "; left out, for it has no numbers: " + no_numbers);
  columns.names = std::move(names);
  return columns;
}

TextColumns columns_by_value(const SampleRows& rows, std::string_view extension) {
  TextColumns columns = Guess(rows, extension)();
  columns.how = fmt::format("guessed from their values{}", scale_told(columns.bytes_per_unit));
  columns.are_guessed = true;
  return columns;
}

std::vector<std::string> told_columns(std::string_view columns) {
  TextDialect dialect;
  if (columns.find(',') != std::string_view::npos) dialect.between = TextDialect::Between::Comma;
  if (columns.find(';') != std::string_view::npos) dialect.between = TextDialect::Between::Semicolon;
  std::vector<std::string_view> words;
  split(columns, dialect, words);
  std::vector<std::string> names;
  names.reserve(words.size());
  for (const std::string_view word : words) {
    const std::string key = lower(word);
    names.push_back(key == "-" || key == "_" || key == "skip" ? std::string() : column_name(word));
  }
  return names;
}

}  // namespace umtet::detail
