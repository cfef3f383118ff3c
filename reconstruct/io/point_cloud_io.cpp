#include "reconstruct/io/point_cloud_io.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <ostream>
#include <set>
#include <system_error>

#include "reconstruct/cloud/cloud_survey.h"
#include "reconstruct/io/detail/cloud_source.h"

namespace umtet {
namespace {

using detail::CloudSource;
using detail::refuse;

constexpr std::size_t kFewestPoints = 10;  // of a surface; what surveys a scan needs more
// Sixth powers of lengths, products of volumes, must stay normal doubles; no unit makes a body so large or so small.
constexpr double kFarthest = 1e50, kSmallest = 1e-50;

/// Headers and rows of numbers have short lines.
void refuse_endless_line(const CloudSource& head) {
  const std::string_view begin = head.bytes.substr(0, 1 << 16);
  if (begin.size() < 1 << 16) return;
  if (begin.find('\n') != std::string_view::npos || begin.find('\r') != std::string_view::npos) return;
  refuse(head, fmt::format("line 1 does not end in the first {} bytes: this is no PLY, PCD or text with a point a line",
                           begin.size()));
}

/// Reads a file in two steps: a beginning, which tells most of what is no cloud before gigabytes are read, and the
/// rest.
class CloudBytes {
 public:
  /// \throw std::system_error  the file cannot be opened; names it
  explicit CloudBytes(const std::filesystem::path& file) : file_(file) {
    if (std::filesystem::is_directory(file)) fail(EISDIR);
    errno = 0;
    in_.open(file, std::ios::binary);
    if (!in_) fail(errno);
    read(kHead);
    std::error_code unknown;  // of a pipe
    const std::uintmax_t size = std::filesystem::file_size(file, unknown);
    if (!unknown && size > bytes_.size()) n_left_ = size - bytes_.size();
  }
  /// What has been read so far.
  CloudSource source(bool needs_normals) const {
    return {.name = file_.string(), .bytes = bytes_, .needs_normals = needs_normals, .bytes_left_out = n_left_};
  }
  void read_rest() {
    bytes_.reserve(bytes_.size() + n_left_ + kHead);  // it grows by a whole step before it is cut
    while (read(kHead)) {
    }
    n_left_ = 0;
  }

 private:
  static constexpr std::size_t kHead = 1 << 20;  // real headers have some hundred bytes, with comments some thousand

  [[noreturn]] void fail(int error) const {
    throw std::system_error(error != 0 ? error : EIO, std::generic_category(), file_.string());
  }
  bool read(std::size_t n) {
    const std::size_t before = bytes_.size();
    bytes_.resize(before + n);
    in_.read(bytes_.data() + before, static_cast<std::streamsize>(n));
    bytes_.resize(before + static_cast<std::size_t>(in_.gcount()));
    if (in_.bad()) fail(errno);
    return in_.gcount() > 0;
  }

  std::filesystem::path file_;
  std::ifstream in_;
  std::string bytes_;
  std::size_t n_left_ = 0;
};

enum class Format { Ply, Pcd, Xyz };

/// What the content says, else what the extension says.
Format format_of(const CloudSource& source, const std::filesystem::path& file) {
  if (source.bytes.empty()) refuse(source, "the file is empty");
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto starts_with = [&](std::string_view text) { return source.bytes.starts_with(text); };
  if (starts_with("ply\n") || starts_with("ply\r\n")) return Format::Ply;
  if (starts_with("# .PCD") || starts_with("VERSION ")) return Format::Pcd;
  if (extension == ".ply") return Format::Ply;
  if (extension == ".pcd") return Format::Pcd;
  if (extension == ".xyz" || extension == ".txt" || extension == ".pts") return Format::Xyz;
  refuse(source,
         "neither PLY nor PCD by its first line, and the extension is none of .xyz .txt .pts: convert it to one "
         "of these");
}

void check_head(const CloudSource& head, const std::filesystem::path& file) {
  refuse_endless_line(head);
  if (head.bytes_left_out == 0) return;  // then the reader itself is as fast
  switch (format_of(head, file)) {
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

// A body needs samples in three dimensions, and more than a handful of places.
void check_extent(const CloudSource& source, const std::vector<Vec3>& points, std::size_t fewest) {
  constexpr double kFlat = 1e-6;  // rounding of single precision makes a plane 1e-7 of its extent thick
  std::set<std::array<double, 3>> places;
  for (std::size_t i = 0; i < points.size() && places.size() < fewest; ++i)
    places.insert({points[i][0], points[i][1], points[i][2]});
  if (places.size() < fewest) {
    refuse(source, fmt::format("{} points at only {} different places: a surface needs at least {}", points.size(),
                               places.size(), fewest));
  }
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : points) mean += x / static_cast<double>(points.size());
  double scale = 0;
  for (const Vec3& x : points) scale = std::max(scale, (x - mean).cwiseAbs().maxCoeff());
  if (scale < kSmallest)
    refuse(source,
           fmt::format("the points are within {:.3g} of each other, less than 1e-50: give them in a smaller unit",
                       2 * scale));
  Mat3 spread = Mat3::Zero();
  for (const Vec3& x : points) spread += (x - mean) / scale * ((x - mean) / scale).transpose();
  const Vec3 extent =
      Eigen::SelfAdjointEigenSolver<Mat3>(spread, Eigen::EigenvaluesOnly).eigenvalues().cwiseMax(0).cwiseSqrt();
  if (extent[0] < kFlat * extent[2]) {
    refuse(source, fmt::format("all points lie on one {}: they do not bound a body",
                               extent[1] < kFlat * extent[2] ? "line" : "plane"));
  }
}

void check_numbers(const CloudSource& source, const OrientedPointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  if (n < kFewestPoints) refuse(source, fmt::format("{} points: a surface needs at least {}", n, kFewestPoints));
  refuse_points(
      source, n, [&](std::size_t i) { return !cloud.points[i].allFinite(); },
      "has a coordinate that is NaN or infinite");
  refuse_points(
      source, n, [&](std::size_t i) { return cloud.points[i].cwiseAbs().maxCoeff() > kFarthest; },
      "has a coordinate beyond 1e50");
  refuse_points(
      source, n, [&](std::size_t i) { return !cloud.normals[i].allFinite(); }, "has a normal that is NaN or infinite");
  refuse_points(
      source, n, [&](std::size_t i) { return cloud.normals[i].isZero(0); }, "has a zero normal");
  check_extent(source, cloud.points, kFewestPoints);
}

/// Returns how many normals were not unit to 1e-3. Normals unit to rounding stay as they are, so that a written cloud
/// is read back bit by bit.
std::size_t make_unit(std::vector<Vec3>& normals) {
  constexpr double kRounding = 1e-14, kWorthTelling = 1e-3;
  std::size_t n_rescaled = 0;
  for (Vec3& n : normals) {
    if (n.isZero(0)) continue;  // only read_scan lets them pass
    const double length = n.stableNorm();
    if (std::abs(length - 1) > kWorthTelling) ++n_rescaled;
    if (std::abs(length - 1) <= kRounding) continue;
    // First to the order of 1: the squares of very short and very long normals are no doubles.
    n /= n.cwiseAbs().maxCoeff();
    n /= n.norm();
  }
  return n_rescaled;
}

/// Points that are no numbers go, unusable normals become zero.
void drop_unusable(const CloudSource& source, CloudFile& file) {
  OrientedPointCloud& cloud = file.cloud;
  const std::size_t n = cloud.points.size();
  const bool has_normals = !cloud.normals.empty(), has_labels = !cloud.labels.empty(),
             has_origins = !cloud.origins.empty();
  std::size_t n_kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& x = cloud.points[i];
    if (!x.allFinite() || x.cwiseAbs().maxCoeff() > kFarthest) continue;
    cloud.points[n_kept] = x;
    if (has_normals) {
      const bool is_missing = !cloud.normals[i].allFinite() || cloud.normals[i].isZero(0);
      if (is_missing) ++file.report.n_normals_missing;
      cloud.normals[n_kept] = is_missing ? Vec3::Zero() : cloud.normals[i];
    }
    if (has_labels) cloud.labels[n_kept] = cloud.labels[i];
    if (has_origins) cloud.origins[n_kept] = cloud.origins[i];
    ++n_kept;
  }
  file.report.n_points_dropped = n - n_kept;
  if (2 * file.report.n_points_dropped > n)
    refuse(source, fmt::format("{} of {} points have coordinates that are NaN, infinite or beyond 1e50: that is no "
                               "cloud with a few bad points, export it again",
                               file.report.n_points_dropped, n));
  cloud.points.resize(n_kept);
  if (has_normals) cloud.normals.resize(n_kept);
  if (has_labels) cloud.labels.resize(n_kept);
  if (has_origins) cloud.origins.resize(n_kept);
}

template <class T>
void put(char*& at, T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  at = std::copy(bytes.begin(), bytes.end(), at);
}

}  // namespace

CloudFile read_point_cloud(const std::filesystem::path& file) {
  CloudBytes bytes(file);
  check_head(bytes.source(true), file);
  bytes.read_rest();
  const CloudSource source = bytes.source(true);
  CloudFile result = parse(source, file);
  check_numbers(source, result.cloud);
  result.report.n_points = result.cloud.points.size();
  result.report.n_normals_rescaled = make_unit(result.cloud.normals);
  return result;
}

void check_scan_head(const std::filesystem::path& file) { check_head(CloudBytes(file).source(false), file); }

CloudFile read_scan(const std::filesystem::path& file) {
  CloudBytes bytes(file);
  check_head(bytes.source(false), file);
  bytes.read_rest();
  const CloudSource source = bytes.source(false);
  CloudFile result = parse(source, file);
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
  const bool has_labels = !cloud.labels.empty();
  if (has_labels && cloud.labels.size() != cloud.points.size())
    throw std::invalid_argument(
        fmt::format("{} points but {} labels: must be equal", cloud.points.size(), cloud.labels.size()));
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << cloud.points.size() << '\n';
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) out << "property double " << name << '\n';
  if (has_labels) out << "property int label\n";
  out << "end_header\n";
  std::array<char, 6 * sizeof(double) + sizeof(std::int32_t)> row;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    char* at = row.data();
    for (const Vec3* v : {&cloud.points[i], &cloud.normals[i]})
      for (int axis = 0; axis < 3; ++axis) put(at, (*v)[axis]);
    if (has_labels) put(at, std::int32_t{cloud.labels[i]});
    out.write(row.data(), at - row.data());
  }
}

}  // namespace umtet
