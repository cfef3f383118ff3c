#include "reconstruct/io/point_cloud_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <ostream>
#include <vector>

#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/io/detail/clouds/cloud_readers.h"
#include "reconstruct/io/detail/clouds/field_columns.h"
#include "reconstruct/io/detail/clouds/text_columns.h"
#include "reconstruct/io/detail/extent.h"
#include "reconstruct/io/detail/file_bytes.h"
#include "reconstruct/io/detail/little_endian.h"

namespace umtet {
namespace {

using detail::check_extent;
using detail::CloudSource;
using detail::FileBytes;
using detail::kColumns;
using detail::refuse;

constexpr std::size_t kFewestPoints = 10;  // of a surface; what surveys a scan needs more

enum class Format { Ply, Pcd, Xyz };

/// Formats of surveys. No library of Debian reads them, nor does Debian's build of CloudCompare; other programs turn
/// them into one that is read.
void refuse_survey_formats(const CloudSource& source, const std::string& extension) {
  const bool is_las = source.bytes.starts_with("LASF") || extension == ".las" || extension == ".laz";
  if (!is_las && !source.bytes.starts_with("ASTM-E57") && extension != ".e57") return;
  refuse(source,
         fmt::format("{} is not read: make it a PLY with 'CloudCompare -SILENT -O FILE -C_EXPORT_FMT PLY "
                     "-SAVE_CLOUDS' (the build of cloudcompare.org){}",
                     is_las ? "LAS or LAZ" : "E57", is_las ? " or 'pdal translate FILE FILE.ply' (pdal.io)" : ""));
}

/// What the content says, else what the extension says.
Format format_of(const CloudSource& source, const std::filesystem::path& file) {
  if (source.bytes.empty()) refuse(source, "the file is empty");
  const std::string extension = detail::lower_extension(file);
  const auto starts_with = [&](std::string_view text) { return source.bytes.starts_with(text); };
  if (starts_with("ply\n") || starts_with("ply\r\n")) return Format::Ply;
  if (starts_with("# .PCD") || starts_with("VERSION ")) return Format::Pcd;
  if (extension == ".ply") return Format::Ply;
  if (extension == ".pcd") return Format::Pcd;
  constexpr std::string_view kTexts[] = {".xyz", ".txt", ".pts", ".asc", ".csv", ".xyzn", ".xyzrgb", ".npts"};
  if (std::find(std::begin(kTexts), std::end(kTexts), extension) != std::end(kTexts)) return Format::Xyz;
  refuse_survey_formats(source, extension);
  if (detail::is_xyz(source)) return Format::Xyz;
  refuse(source,
         "neither PLY, PCD nor OFF by its first line, no table of numbers, and the extension is none of .xyz .txt .csv "
         ".asc .pts .stl .obj .off: convert it to one of these");
}

void check_head(const CloudSource& head, const std::filesystem::path& file) {
  detail::refuse_endless_line(head);
  const Format format = format_of(head, file);
  if (format != Format::Xyz && !head.columns.empty())
    refuse(head, {kColumns, " is about tables in text: PLY and PCD name their properties and fields themselves"});
  if (head.bytes_left_out == 0) return;  // then the reader itself is as fast
  switch (format) {
    case Format::Ply:
      return detail::check_ply_head(head);
    case Format::Pcd:
      return detail::check_pcd_head(head);
    case Format::Xyz:
      return detail::check_xyz_head(head);
  }
}

CloudFile parse(const CloudSource& source, const std::filesystem::path& file) {
  switch (format_of(source, file)) {
    case Format::Ply:
      return detail::read_ply(source);
    case Format::Pcd:
      return detail::read_pcd(source);
    case Format::Xyz:
      break;
  }
  return detail::read_xyz(source);
}

bool is_in_blocks(const CloudSource& head, const std::filesystem::path& file) {
  const Format format = format_of(head, file);
  return (format == Format::Ply && detail::is_in_blocks_ply(head)) ||
         (format == Format::Pcd && detail::is_in_blocks_pcd(head));
}

/// Block by block where that can be: gigabytes of bytes are not held beside what they mean.
CloudFile parse(FileBytes& bytes, const std::filesystem::path& file, bool needs_normals, const std::string& columns) {
  CloudSource head = bytes.source(needs_normals);
  head.columns = columns;
  check_head(head, file);
  if (head.bytes_left_out > 0 && is_in_blocks(head, file)) return parse(bytes.in_blocks(needs_normals), file);
  bytes.read_rest();
  CloudSource whole = bytes.source(needs_normals);
  whole.columns = columns;
  return parse(whole, file);
}

/// Counts the points for which bad(i) holds; names the first.
template <class Predicate>
void refuse_points(const CloudSource& source, std::size_t n, Predicate bad, std::string_view what) {
  std::size_t first = n, count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (bad(i)) {
      first = std::min(first, i);
      ++count;
    }
  if (count > 0)
    refuse(source, fmt::format("point {} of {} (counted from 1) {}, {} such points in all: remove them", first + 1, n,
                               what, count));
}

void check_numbers(const CloudSource& source, const OrientedPointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  if (n < kFewestPoints) refuse(source, fmt::format("{} points: a surface needs at least {}", n, kFewestPoints));
  refuse_points(
      source, n, [&](std::size_t i) { return !cloud.points[i].allFinite(); },
      "has a coordinate that is NaN or infinite");
  refuse_points(
      source, n, [&](std::size_t i) { return cloud.points[i].cwiseAbs().maxCoeff() > detail::kFarthest; },
      "has a coordinate beyond 1e50");
  refuse_points(
      source, n, [&](std::size_t i) { return !cloud.normals[i].allFinite(); }, "has a normal that is NaN or infinite");
  refuse_points(
      source, n, [&](std::size_t i) { return cloud.normals[i].isZero(0); }, "has a zero normal");
  refuse_points(
      source, cloud.counts.size(), [&](std::size_t i) { return cloud.counts[i] < 1; }, "is merged of none");
  refuse_points(
      source, cloud.spreads.size(),
      [&](std::size_t i) { return !(cloud.spreads[i] >= 0 && cloud.spreads[i] <= detail::kFarthest); },
      "has a spread that is none");
  check_extent(source, cloud.points, kFewestPoints);
}

/// Returns how many normals were not unit to 1e-3.
std::size_t make_unit(std::vector<Vec3>& normals) {
  constexpr double kWorthTelling = 1e-3;
  std::size_t n_rescaled = 0;
  for (Vec3& n : normals) {
    if (n.isZero(0)) continue;  // only read_scan lets them pass
    if (std::abs(n.stableNorm() - 1) > kWorthTelling) ++n_rescaled;
    n = unit_normal(n);
  }
  return n_rescaled;
}

/// Points that are no numbers go, unusable normals become zero.
void drop_unusable(const CloudSource& source, CloudFile& file) {
  OrientedPointCloud& cloud = file.cloud;
  const std::size_t n = cloud.points.size();
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& x = cloud.points[i];
    if (x.allFinite() && x.cwiseAbs().maxCoeff() <= detail::kFarthest) kept.push_back(static_cast<std::uint32_t>(i));
  }
  file.report.n_points_dropped = n - kept.size();
  if (2 * file.report.n_points_dropped > n)
    refuse(source, fmt::format("{} of {} points have coordinates that are NaN, infinite or beyond 1e50: that is no "
                               "cloud with a few bad points, export it again",
                               file.report.n_points_dropped, n));
  if (kept.size() < n) keep_samples(cloud, kept);
  for (Vec3& normal : cloud.normals) {
    if (normal.allFinite() && !normal.isZero(0)) continue;
    ++file.report.n_normals_missing;
    normal = Vec3::Zero();
  }
}

}  // namespace

CloudFile read_point_cloud(const std::filesystem::path& file, const std::string& columns) {
  const InputFile input(file);
  FileBytes bytes(input);
  CloudFile result = parse(bytes, file, true, columns);
  const CloudSource source = bytes.source(true);  // names the file
  check_numbers(source, result.cloud);
  result.report.n_points = result.cloud.points.size();
  result.report.n_normals_rescaled = make_unit(result.cloud.normals);
  return result;
}

void check_scan_head(const InputFile& file, const std::string& columns) {
  const FileBytes bytes(file);
  CloudSource head = bytes.source(false);
  head.columns = columns;
  check_head(head, file.path());
}

std::string problem_of_columns(const std::string& columns) {
  if (columns.empty()) return "";
  std::vector<std::string> names = detail::told_columns(columns);
  if (!detail::has_axes(names)) return "x, y and z must be among them";
  std::sort(names.begin(), names.end());
  const auto twice =
      std::adjacent_find(names.begin(), names.end(), [](const auto& a, const auto& b) { return !a.empty() && a == b; });
  return twice == names.end() ? "" : *twice + " is there twice";
}

CloudFile read_scan(const std::filesystem::path& file, const std::string& columns) {
  return read_scan(InputFile(file), columns);
}

CloudFile read_scan(const InputFile& file, const std::string& columns) {
  FileBytes bytes(file);
  CloudFile result = parse(bytes, file.path(), false, columns);
  const CloudSource source = bytes.source(false);  // names the file
  result.cloud.counts = {}, result.cloud.spreads = {};
  result.report.n_points = result.cloud.points.size();
  drop_unusable(source, result);
  if (result.cloud.points.size() < kFewestSurveyed)
    refuse(source, fmt::format("{} points: a surface needs at least {}", result.cloud.points.size(), kFewestSurveyed));
  check_extent(source, result.cloud.points, kFewestSurveyed);
  result.report.n_normals_rescaled = make_unit(result.cloud.normals);
  return result;
}

void write_ply(std::ostream& out, const OrientedPointCloud& cloud) {
  if (cloud.points.size() != cloud.normals.size())
    throw std::invalid_argument(
        fmt::format("{} points but {} normals: must be equal", cloud.points.size(), cloud.normals.size()));
  require_equal_lengths(cloud);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << cloud.points.size() << '\n';
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) out << "property double " << name << '\n';
  if (!cloud.labels.empty()) out << "property int label\n";
  if (!cloud.colours.empty()) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!cloud.counts.empty()) out << "property int " << detail::kCount << '\n';
  if (!cloud.spreads.empty()) out << "property double " << detail::kSpread << '\n';
  for (const SampleField& field : cloud.fields) out << "property double " << field.name << '\n';
  out << "end_header\n";
  std::vector<char> row((7 + cloud.fields.size()) * sizeof(double) + 2 * sizeof(std::int32_t) + sizeof(Colour));
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    char* at = row.data();
    for (const Vec3* v : {&cloud.points[i], &cloud.normals[i]})
      for (int axis = 0; axis < 3; ++axis) detail::put(at, (*v)[axis]);
    if (!cloud.labels.empty()) detail::put(at, std::int32_t{cloud.labels[i]});
    if (!cloud.colours.empty())
      for (const std::uint8_t c : cloud.colours[i]) detail::put(at, c);
    if (!cloud.counts.empty()) detail::put(at, std::int32_t{cloud.counts[i]});
    if (!cloud.spreads.empty()) detail::put(at, cloud.spreads[i]);
    for (const SampleField& field : cloud.fields) detail::put(at, field.values[i]);
    out.write(row.data(), at - row.data());
  }
}

}  // namespace umtet
