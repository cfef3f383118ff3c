#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "reconstruct/detail/cloud_source.h"
#include "reconstruct/detail/text_rows.h"

namespace umtet::detail {
namespace {

constexpr std::array<std::size_t, 6> kColumns = {0, 1, 2, 3, 4, 5};  // x y z nx ny nz

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
    refuse(source, fmt::format("line {}: {} columns, expected x y z or x y z nx ny nz", line, n_columns));
  if (n_columns == 3)
    refuse(source, fmt::format("line {}: three columns, so the points have no normals: estimate and orient them first, "
                               "for example in CloudCompare or MeshLab, and export x y z nx ny nz",
                               line));
  refuse(source, fmt::format("line {}: {} columns, expected the six of x y z nx ny nz", line, n_columns));
}

}  // namespace

CloudFile read_xyz(const CloudSource& source) {
  CloudFile file;
  file.report.format = "xyz";
  LineReader lines(source.bytes);
  std::string_view line;
  std::vector<std::string_view> tokens;
  std::vector<double> row;
  CloudColumns columns{kColumns};
  std::optional<std::uint64_t> announced;  // .pts files start with a line that holds the number of points
  bool first = true;
  while (lines.next_filled(line)) {
    split(line, " \t", tokens);
    if (tokens.front().starts_with('#') || tokens.front().starts_with("//")) continue;
    const bool may_announce = std::exchange(first, false) && tokens.size() == 1;
    if (may_announce && (announced = parse_count(tokens.front()))) continue;
    refuse_decimal_commas(source, lines.line(), tokens);
    split(line, " \t,", tokens);
    const bool fits = tokens.size() == 6 || (tokens.size() == 3 && !source.needs_normals);
    if (!fits || (!row.empty() && tokens.size() != row.size()))
      refuse_columns(source, lines.line(), tokens.size(), fits ? row.size() : 0);
    row.resize(tokens.size());
    columns.has_normals = row.size() == 6;
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = parse_number(source, lines.line(), tokens[c]);
    append_point(file.cloud, row, columns);
  }
  if (announced && *announced != file.cloud.points.size())
    refuse(source, fmt::format("the first line announces {} points, {} follow: the file is cut short or was edited",
                               *announced, file.cloud.points.size()));
  return file;
}

}  // namespace umtet::detail
