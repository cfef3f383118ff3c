#include "reconstruct/io/detail/triangles/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "reconstruct/io/detail/extent.h"

namespace umtet::detail {
namespace {

using Point = Eigen::Vector2d;

constexpr std::size_t kTries = 10;  // of ears, for each corner

double turn(const Point& a, const Point& b, const Point& c) {
  const Point u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

/// The polygon in its own plane, counter-clockwise; Newell's normal.
std::vector<Point> flattened(const std::vector<Vec3>& polygon) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    normal += (polygon[i] - polygon[0]).cross(polygon[(i + 1) % polygon.size()] - polygon[0]);
  const double length = normal.stableNorm();
  if (!(length > 0)) return {};
  normal /= length;
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  const Vec3 e = normal.cross(Vec3::Unit(least)).normalized(), f = normal.cross(e);
  std::vector<Point> flat;
  for (const Vec3& x : polygon) flat.emplace_back(e.dot(x - polygon[0]), f.dot(x - polygon[0]));
  return flat;
}

/// Is the corner at i convex, with no other corner of what is left in its triangle?
bool is_ear(const std::vector<Point>& flat, const std::vector<int>& left, std::size_t i) {
  const std::size_t n = left.size();
  const int a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
  if (!(turn(flat[a], flat[b], flat[c]) > 0)) return false;
  return std::none_of(left.begin(), left.end(), [&](int p) {
    if (p == a || p == b || p == c) return false;
    const Point& x = flat[p];
    return turn(flat[a], flat[b], x) >= 0 && turn(flat[b], flat[c], x) >= 0 && turn(flat[c], flat[a], x) >= 0 &&
           x != flat[a] && x != flat[c];
  });
}

/// Labels are 1, 2 ... of names that are a few; else there are none.
void name_labels(std::vector<int>& labels, const NameTable& names, TriangleFileReport& report) {
  const std::size_t n = names.names().size();
  if (n > kMostGroups) report.n_groups_ignored = n;
  if (n < 2 || n > kMostGroups) return labels.clear();
  report.label_names = names.names();
  for (int& label : labels) ++label;
}

/// Takes the lines that are sides of triangles. @param number  of each vertex of the file, in the mesh; -1: none
void take_lines(const std::vector<std::array<int, 2>>& lines, const std::vector<int>& number, TriangleFile& file) {
  if (lines.empty()) return;
  std::set<std::pair<int, int>> sides;
  for (const Triangle& f : file.mesh.F)
    for (int k = 0; k < 3; ++k) sides.insert(std::minmax({f[k], f[(k + 1) % 3]}));
  const auto n = static_cast<int>(number.size());
  for (const auto& [a, b] : lines) {
    const bool is_side = a < n && b < n && sides.contains(std::minmax({number[a], number[b]}));
    if (is_side) file.mesh.lines.push_back({number[a], number[b]});
    file.report.n_lines_ignored += is_side ? 0 : 1;
  }
  file.report.n_lines = file.mesh.lines.size();
}

}  // namespace

int NameTable::number_of(std::string_view name) {
  const auto [found, is_new] = numbers_.emplace(std::string(name), static_cast<int>(names_.size()));
  if (is_new) names_.emplace_back(name);
  return found->second;
}

std::vector<std::array<int, 3>> cut_polygon(const std::vector<Vec3>& polygon) {
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> left(polygon.size());
  std::iota(left.begin(), left.end(), 0);
  const std::vector<Point> flat = polygon.size() > 3 ? flattened(polygon) : std::vector<Point>();
  // Ears of real polygons are found at once; hostile ones would take the cube of their corners.
  std::size_t tries = kTries * polygon.size(), ear = 0;
  while (left.size() > 3 && !flat.empty()) {
    const std::size_t n = left.size();
    std::size_t looked_at = 0;
    for (ear %= n; looked_at < n && tries > 0 && !is_ear(flat, left, ear); ear = (ear + 1) % n) ++looked_at, --tries;
    if (looked_at == n || tries == 0) break;
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  for (std::size_t k = 1; k + 1 < left.size(); ++k) triangles.push_back({left[0], left[k], left[k + 1]});
  return triangles;
}

TriangleFile triangles_of(const CloudSource& source, PolygonSoup soup, std::string format, const NameTable* names) {
  TriangleFile file;
  file.report.format = std::move(format);
  file.report.n_vertices = soup.V.size();
  file.report.n_faces = soup.size();
  if (soup.size() == 0) refuse(source, "no faces: export the surface as triangles");
  const auto n_vertices =
      static_cast<std::int64_t>(std::min<std::size_t>(soup.V.size(), std::numeric_limits<int>::max()));
  if (names) name_labels(soup.labels, *names, file.report);
  TriangleMesh& mesh = file.mesh;
  std::vector<Vec3> polygon;
  std::vector<std::uint8_t> is_used(soup.V.size(), 0);
  for (std::size_t p = 0; p < soup.size(); ++p) {
    const std::size_t begin = soup.begin(p), n = soup.ends[p] - begin;
    const auto place = [&] { return fmt::format("face {} of {} (counted from 1)", p + 1, soup.size()); };
    if (n < 3) refuse(source, fmt::format("{} has {} corners: a face has three at least", place(), n));
    if (n > kMostCorners)
      refuse(source, fmt::format("{} has {} corners, more than {}: export triangles", place(), n, kMostCorners));
    polygon.clear();
    for (std::size_t i = begin; i < soup.ends[p]; ++i) {
      const std::int64_t v = soup.corners[i];
      if (v < 0 || v >= n_vertices)
        refuse(source, fmt::format("{} has a corner at vertex {} (counted from 0), but there are {} vertices: the file "
                                   "is damaged, export it again",
                                   place(), v, soup.V.size()));
      const Vec3& x = soup.V[v];
      if (!(x.allFinite() && x.cwiseAbs().maxCoeff() <= kFarthest))
        refuse(source, fmt::format("{} has a corner that is NaN, infinite or beyond 1e50, vertex {} (counted from 0): "
                                   "the file is damaged, export it again",
                                   place(), v));
      is_used[v] = 1;
      polygon.push_back(x);
    }
    if (n > 3) ++file.report.n_polygons;
    for (const std::array<int, 3>& t : cut_polygon(polygon)) {
      mesh.F.push_back({static_cast<int>(soup.corners[begin + t[0]]), static_cast<int>(soup.corners[begin + t[1]]),
                        static_cast<int>(soup.corners[begin + t[2]])});
      if (!soup.labels.empty()) mesh.labels.push_back(soup.labels[p]);
    }
  }
  // Vertices that no face uses may be anywhere, and may be no numbers.
  std::vector<int> number(soup.V.size(), -1);
  for (std::size_t v = 0; v < is_used.size(); ++v) {
    if (!is_used[v]) continue;
    number[v] = static_cast<int>(mesh.V.size());
    mesh.V.push_back(soup.V[v]);
  }
  for (Triangle& f : mesh.F)
    for (int& v : f) v = number[v];
  check_extent(source, mesh.V, 4);
  take_lines(soup.lines, number, file);
  return file;
}

}  // namespace umtet::detail
