#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "reconstruct/io/detail/clouds/cloud_columns.h"
#include "reconstruct/io/detail/clouds/cloud_readers.h"
#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

constexpr std::array<std::size_t, 10> kColumns = {0, 1, 2, 3, 4, 5, 6};  // x y z nx ny nz label, or x y z label
// More different whole numbers in a column without a name are intensities.
constexpr std::size_t kMostLabels = 64;
// Of a damaged or binary file a line may be gigabytes.
constexpr std::size_t kLongestLine = 1 << 16;

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// "0,25": one comma inside, a digit on both sides.
bool has_decimal_comma(std::string_view token) {
  const std::size_t comma = token.find(',');
  return comma != std::string_view::npos && comma > 0 && comma + 1 < token.size() && is_digit(token[comma - 1]) &&
         is_digit(token[comma + 1]) && token.find(',', comma + 1) == std::string_view::npos;
}

/// Commas separate columns, so "0,1 0,2 0,3" would pass as six columns: where blanks separate numbers too, a comma
/// between digits is a decimal comma.
void refuse_decimal_commas(const CloudSource& source, std::size_t line,
                           const std::vector<std::string_view>& by_blanks) {
  if (by_blanks.size() > 1 && std::any_of(by_blanks.begin(), by_blanks.end(), has_decimal_comma))
    refuse(source, fmt::format("line {}: numbers with decimal commas: export with decimal points", line));
}

[[noreturn]] void refuse_columns(const CloudSource& source, std::size_t line, std::size_t n_columns,
                                 std::size_t n_before) {
  if (n_before != 0)
    refuse(source, fmt::format("line {}: {} columns, but {} before: the file is cut short or damaged, export it again",
                               line, n_columns, n_before));
  if (!source.needs_normals)
    refuse(source,
           fmt::format("line {}: {} columns, expected x y z or x y z nx ny nz, and perhaps a label", line, n_columns));
  if (n_columns == 3)
    refuse(source, fmt::format("line {}: three columns, so the points have no normals: estimate and orient them first, "
                               "for example in CloudCompare or MeshLab, and export x y z nx ny nz",
                               line));
  refuse(source,
         fmt::format("line {}: {} columns, expected the six of x y z nx ny nz, and perhaps a label", line, n_columns));
}

/// A last column is the label only if nothing speaks against it: scanners write x y z intensity r g b, too.
void check_labels(const CloudSource& source, const OrientedPointCloud& cloud, bool is_pts) {
  if (cloud.labels.empty()) return;
  const char* const remedy = "export x y z nx ny nz and a label, or PLY, where columns have names";
  if (is_pts) refuse(source, fmt::format("a .pts file with intensities or colours, which are no labels: {}", remedy));
  std::vector<int> labels = cloud.labels;
  std::sort(labels.begin(), labels.end());
  const auto n = static_cast<std::size_t>(std::unique(labels.begin(), labels.end()) - labels.begin());
  if (n > kMostLabels)
    refuse(source, fmt::format("the last column has {} different whole numbers, more than the {} that are taken for "
                               "labels: {}",
                               n, kMostLabels, remedy));
  const auto is_unit = [](const Vec3& normal) { return std::abs(normal.stableNorm() - 1) < .1; };
  const auto n_unit = std::count_if(cloud.normals.begin(), cloud.normals.end(), is_unit);
  if (2 * static_cast<std::size_t>(n_unit) < cloud.normals.size())
    refuse(source, fmt::format("seven columns, but the fourth to sixth are no normals: {}", remedy));
}

/// The names of columns that a comment gives, "//X Y Z R G B Scalar_field Nx Ny Nz"; none unless x, y and z are among
/// them. Those that say what a column is are in lower case.
std::vector<std::string> names_in(std::string_view line) {
  std::vector<std::string_view> tokens;
  split(line.substr(std::min(line.find_first_not_of("#/"), line.size())), " \t,", tokens);
  std::vector<std::string> names;
  for (const std::string_view token : tokens) {
    std::string lower(token);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto is_one_of = [&](const auto&... names) { return ((lower == names) || ...); };
    if (is_one_of("r", "red")) {
      names.emplace_back("red");
    } else if (is_one_of("g", "green")) {
      names.emplace_back("green");
    } else if (is_one_of("b", "blue")) {
      names.emplace_back("blue");
    } else {
      names.push_back(is_reserved(lower) ? lower : std::string(token));
    }
  }
  const auto is_there = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  return is_there("x") && is_there("y") && is_there("z") ? names : std::vector<std::string>();
}

struct Rows {
  CloudColumns columns{kColumns};
  bool have_names = false;
  std::optional<std::uint64_t> announced;  ///< the number of points of the first line: .pts files start with it
};

CloudColumns columns_by_number(std::size_t n) {
  CloudColumns columns{kColumns};
  columns.has_normals = n >= 6;
  columns.has_labels = n % 3 == 1;
  return columns;
}

/// Appends a point for every row.
Rows read_rows(const CloudSource& source, OrientedPointCloud& cloud) {
  LineReader lines(source.bytes);
  std::string_view line;
  std::vector<std::string_view> tokens;
  std::vector<double> row;
  std::vector<std::string> names;
  Rows rows;
  bool first = true;
  while (lines.next_filled(line)) {
    if (line.size() > kLongestLine)
      refuse(source,
             fmt::format("line {}: {} bytes long: this is no text with a point a line", lines.line(), line.size()));
    split(line, " \t", tokens);
    const bool is_comment = tokens.front().starts_with('#') || tokens.front().starts_with("//");
    if (is_comment && row.empty()) {
      if (std::vector<std::string> found = names_in(line); !found.empty()) names = std::move(found);
    }
    if (is_comment) continue;
    const bool may_announce = std::exchange(first, false) && tokens.size() == 1;
    if (may_announce && (rows.announced = parse_count(tokens.front()))) continue;
    refuse_decimal_commas(source, lines.line(), tokens);
    split(line, " \t,", tokens);
    const std::size_t n = tokens.size();
    const bool fits = names.size() == n || n == 6 || n == 7 || ((n == 3 || n == 4) && !source.needs_normals);
    if (!fits || (!row.empty() && n != row.size())) refuse_columns(source, lines.line(), n, fits ? row.size() : 0);
    if (row.empty()) {
      rows.have_names = names.size() == n;
      rows.columns = rows.have_names ? cloud_columns(source, names, "column") : columns_by_number(n);
      begin_cloud(cloud, rows.columns, 0);  // how many rows there are is not known
      row.resize(n);
    }
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = parse_number(source, lines.line(), tokens[c]);
    append_point(source, cloud, row, rows.columns);
  }
  return rows;
}

}  // namespace

void check_xyz_head(const CloudSource& head) {
  CloudSource whole_lines = head;
  whole_lines.bytes = head.bytes.substr(0, head.bytes.rfind('\n') + 1);
  OrientedPointCloud cloud;
  read_rows(whole_lines, cloud);
}

CloudFile read_xyz(const CloudSource& source) {
  CloudFile file;
  file.report.format = "xyz";
  const Rows rows = read_rows(source, file.cloud);
  const std::optional<std::uint64_t>& announced = rows.announced;
  file.report.fields_left_out = rows.columns.fields.left_out;
  if (announced && *announced != file.cloud.points.size())
    refuse(source, fmt::format("the first line announces {} points, {} follow: the file is cut short or was edited",
                               *announced, file.cloud.points.size()));
  if (!rows.have_names) check_labels(source, file.cloud, announced.has_value());
  return file;
}

}  // namespace umtet::detail
