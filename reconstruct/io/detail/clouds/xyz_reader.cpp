#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "reconstruct/io/detail/clouds/cloud_columns.h"
#include "reconstruct/io/detail/clouds/cloud_readers.h"
#include "reconstruct/io/detail/clouds/text_columns.h"
#include "reconstruct/io/detail/clouds/text_table.h"
#include "reconstruct/io/detail/file_bytes.h"
#include "reconstruct/io/detail/text_rows.h"

namespace umtet::detail {
namespace {

// More different whole numbers in a column without a name are intensities.
constexpr std::size_t kMostLabels = 64;

TextColumns columns_of(const CloudSource& source, const TextTable& table) {
  const SampleRows rows = sample_rows(source, table);
  if (!source.columns.empty()) {
    std::vector<std::string> names = told_columns(source.columns);
    if (names.size() > table.n_columns)
      refuse(source, {fmt::format("line {}: {} columns, but ", table.first_line, table.n_columns), kColumns,
                      fmt::format(" names {}", names.size())});
    return columns_by_name(std::move(names), rows, "as given");
  }
  if (!table.header.empty()) return columns_by_name(table.header, rows, "as the header says");
  const std::string extension = table.announced ? ".pts" : lower_extension(source.name);
  return columns_by_value(rows, extension);
}

[[noreturn]] void refuse_problem(const CloudSource& source, const TextTable& table, const TextColumns& columns) {
  refuse(source, {fmt::format("line {}: {} columns: {}", table.first_line, table.n_columns, columns.problem),
                  {{Change::Give, {kColumns, "x,y,z,nx,ny,nz"}, "or the like to say what they are"},
                   {Change::Give, {kColumns, "x,y,z"}, "to leave them out"}}});
}

CloudColumns cloud_columns_of(const CloudSource& source, const TextTable& table, const TextColumns& columns) {
  CloudSource of_any = source;
  of_any.needs_normals = false;  // what is said of missing ones is said below
  std::vector<std::string> names = columns.names;
  std::replace(names.begin(), names.end(), std::string(), std::string("left out"));  // no name of a field has a blank
  CloudColumns of_cloud = cloud_columns(of_any, names, "column");
  if (source.needs_normals && !of_cloud.has_normals)
    refuse(source, fmt::format("line {}: {}: the points have no normals: estimate and orient them first, for example "
                               "in CloudCompare or MeshLab, and export x y z nx ny nz",
                               table.first_line, told(columns)));
  of_cloud.fields.bytes_per_unit = columns.bytes_per_unit;
  return of_cloud;
}

/// Reads the rows of a table.
class RowReader {
 public:
  RowReader(const CloudSource& source, const TextTable& table, const CloudColumns& columns)
      : source_(source), table_(table), columns_(columns), row_(table.n_columns) {
    wanted_ = columns.fields.wanted();
    wanted_.insert(wanted_.end(), columns.begin(), columns.end());
    std::sort(wanted_.begin(), wanted_.end());
  }

  /// Appends a point for each. @return how many points were announced, where a number of them stands before the rows
  std::optional<std::uint64_t> operator()(OrientedPointCloud& cloud) {
    begin_cloud(cloud, columns_, 0);  // how many rows there are is not known
    std::optional<std::uint64_t> announced = table_.announced;
    LineReader lines(source_.bytes, table_.begin, table_.first_line, table_.dialect.end_of_line);
    std::string_view line;
    while (lines.next_filled(line)) {
      if (line.size() > kLongestLine)
        refuse(source_,
               fmt::format("line {}: {} bytes long: this is no text with a point a line", lines.line(), line.size()));
      const std::size_t n = split_row(line, table_, tokens_);
      if (is_comment(line)) continue;
      if (n == 1 && announced == cloud.points.size()) {  // the next scan of a .pts file
        if (const std::optional<std::uint64_t> more = parse_count(tokens_.front())) {
          if (*more > source_.bytes.size()) refuse_count(lines.line(), *more);
          *announced += *more;
          continue;
        }
      }
      if (n != table_.n_columns) refuse_columns(lines.line(), n);
      for (const std::size_t c : wanted_) row_[c] = number(lines.line(), c);
      append_point(source_, cloud, row_, columns_);
    }
    return announced;
  }

 private:
  double number(std::size_t line, std::size_t column) const {
    const std::string_view token = tokens_[column];
    double value = 0;
    if (parse_number(token, table_.dialect, value)) return value;
    if (is_missing(token)) return std::numeric_limits<double>::quiet_NaN();
    refuse(source_, fmt::format("line {}, column {}: {} is not a number of double precision{}", line, column + 1,
                                in_quotes(token), remedy(token)));
  }

  const char* remedy(std::string_view token) const {
    if (token.find(',') == std::string_view::npos) return ": remove the line, or export the file again";
    return ": if that is a decimal comma, separate columns by semicolons or tabs";
  }

  [[noreturn]] void refuse_count(std::size_t line, std::uint64_t count) const {
    refuse(source_, fmt::format("line {}: {} points are announced, more than the file can hold", line, count));
  }

  [[noreturn]] void refuse_columns(std::size_t line, std::size_t n) const {
    refuse(source_,
           fmt::format("line {}: {} column{}, but {} before: the file is cut short or damaged, export it again", line,
                       n, n == 1 ? "" : "s", table_.n_columns));
  }

  const CloudSource& source_;
  const TextTable& table_;
  const CloudColumns& columns_;
  std::vector<std::size_t> wanted_;
  std::vector<std::string_view> tokens_;
  std::vector<double> row_;
};

/// Whole numbers of 32 bits, few of them different.
bool are_labels(const std::vector<double>& values) {
  std::vector<double> different;
  for (const double v : values) {
    if (!(v == std::trunc(v)) || std::abs(v) > std::numeric_limits<int>::max()) return false;
    const auto at = std::lower_bound(different.begin(), different.end(), v);
    if (at != different.end() && *at == v) continue;
    if (different.size() == kMostLabels) return false;
    different.insert(at, v);
  }
  return true;
}

/// A last column that may be one becomes the label.
void find_label(OrientedPointCloud& cloud, const FieldColumns& fields, TextColumns& columns) {
  const auto scalar = std::find_if(fields.scalars.begin(), fields.scalars.end(),
                                   [&](const FieldColumns::Scalar& s) { return s.at == columns.perhaps_label; });
  if (scalar == fields.scalars.end()) return;
  const auto field = cloud.fields.begin() + (scalar - fields.scalars.begin());
  if (!are_labels(field->values)) return;
  cloud.labels.assign(field->values.begin(), field->values.end());
  cloud.fields.erase(field);
  columns.names[columns.perhaps_label] = "label";
}

}  // namespace

bool is_xyz(const CloudSource& source) { return is_table(source); }

void check_xyz_head(const CloudSource& head) {
  CloudSource whole_lines = head;
  const TextTable table = find_table(head);
  whole_lines.bytes = head.bytes.substr(0, head.bytes.rfind(table.dialect.end_of_line) + 1);
  if (table.begin > whole_lines.bytes.size()) return;
  const TextColumns columns = columns_of(whole_lines, table);
  if (!columns.problem.empty()) return;  // the rest of the rows may tell
  OrientedPointCloud cloud;
  RowReader(whole_lines, table, cloud_columns_of(head, table, columns))(cloud);
}

CloudFile read_xyz(const CloudSource& source) {
  CloudFile file;
  file.report.format = "text";
  const TextTable table = find_table(source);
  TextColumns columns = columns_of(source, table);
  if (!columns.problem.empty()) refuse_problem(source, table, columns);
  const CloudColumns of_cloud = cloud_columns_of(source, table, columns);
  const std::optional<std::uint64_t> announced = RowReader(source, table, of_cloud)(file.cloud);
  if (announced && *announced != file.cloud.points.size())
    refuse(source, fmt::format("the first line announces {} points, {} follow: the file is cut short or was edited",
                               *announced, file.cloud.points.size()));
  find_label(file.cloud, of_cloud.fields, columns);
  file.report.fields_left_out = of_cloud.fields.left_out;
  file.report.columns = told(columns);
  file.report.columns_are_guessed = columns.are_guessed;
  return file;
}

}  // namespace umtet::detail
