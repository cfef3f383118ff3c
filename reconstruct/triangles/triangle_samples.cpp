#include "reconstruct/triangles/triangle_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <unordered_map>

#include "common/formatted.h"
#include "common/polled_loops.h"

namespace umtet {
namespace {

// Darts for each sample that there is room for: six leave few places where another would stay.
constexpr double kDarts = 6;
// Of the spacing: with so many darts, those that keep a distance r are .55 area / r^2.
constexpr double kRadius = .74;
// Cosine between normals of sheets that look away from each other.
constexpr double kAway = -.5;

/// From 0 up to 1, the same for the same numbers [Steele2014].
double uniform(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t z = (seed + 1) * 0x9e3779b97f4a7c15 + number * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/// Darts by cells twice as wide as the radius: those nearer than it are in eight cells.
class DartBoard {
 public:
  DartBoard(const Vec3& low, double radius) : low_(low), radius_(radius) {}

  bool has_room(const Vec3& x, const Vec3& normal) const {
    const Cell first = cell(x - Vec3::Constant(radius_)), last = cell(x + Vec3::Constant(radius_));
    for (std::int64_t i = first[0]; i <= last[0]; ++i)
      for (std::int64_t j = first[1]; j <= last[1]; ++j)
        for (std::int64_t k = first[2]; k <= last[2]; ++k) {
          const auto found = head_.find(key({i, j, k}));
          if (found == head_.end()) continue;
          for (int d = found->second; d >= 0; d = next_[d]) {
            if ((points_[d] - x).squaredNorm() < radius_ * radius_ && normals_[d].dot(normal) > kAway) return false;
          }
        }
    return true;
  }
  void add(const Vec3& x, const Vec3& normal) {
    const auto [head, is_new] = head_.emplace(key(cell(x)), -1);
    next_.push_back(head->second);
    head->second = static_cast<int>(points_.size());
    points_.push_back(x);
    normals_.push_back(normal);
  }
  std::vector<Vec3> take_points() { return std::move(points_); }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell(const Vec3& x) const {
    Cell c;
    for (int a = 0; a < 3; ++a) c[a] = static_cast<std::int64_t>(std::floor((x[a] - low_[a]) / (2 * radius_)));
    return c;
  }
  /// Cells that share a key share a list, which costs time and nothing else.
  static std::uint64_t key(const Cell& c) {
    return static_cast<std::uint64_t>(c[0]) * 73856093 ^ static_cast<std::uint64_t>(c[1]) * 19349663 ^
           static_cast<std::uint64_t>(c[2]) * 83492791;
  }

  const Vec3 low_;
  const double radius_;
  std::unordered_map<std::uint64_t, int> head_;
  std::vector<int> next_;
  std::vector<Vec3> points_, normals_;
};

}  // namespace

TriangleSamples sample_triangles(const TriangleMesh& mesh, double spacing, std::uint64_t seed, const Context& context) {
  std::vector<double> up_to;  // area of this triangle and those before
  up_to.reserve(mesh.F.size());
  double area = 0;
  Vec3 low = Vec3::Zero();
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    area += mesh.area_vector(f).norm();
    up_to.push_back(area);
    for (int k = 0; k < 3; ++k) low = f == 0 && k == 0 ? mesh.corner(f, k) : Vec3(low.cwiseMin(mesh.corner(f, k)));
  }
  const double n_darts = std::ceil(kDarts * area / (spacing * spacing));
  if (!(area > 0 && spacing > 0 && n_darts < 0x1p31))
    throw std::invalid_argument(
        formatted("area %g, spacing %g: must be > 0, with fewer than 2^31 darts", area, spacing));
  DartBoard board(low, kRadius * spacing);
  TriangleSamples made;
  for (std::uint64_t dart = 0; dart < static_cast<std::uint64_t>(n_darts); ++dart) {
    if (dart % kValuesPerPoll == 0) context.poll();
    const double at = area * uniform(seed, 3 * dart);
    const auto f = std::min<std::size_t>(
        static_cast<std::size_t>(std::upper_bound(up_to.begin(), up_to.end(), at) - up_to.begin()), up_to.size() - 1);
    const double s = std::sqrt(uniform(seed, 3 * dart + 1)), t = uniform(seed, 3 * dart + 2);
    const Vec3 x = (1 - s) * mesh.corner(f, 0) + s * (1 - t) * mesh.corner(f, 1) + s * t * mesh.corner(f, 2);
    const Vec3 normal = mesh.area_vector(f).normalized();
    if (!board.has_room(x, normal)) continue;
    board.add(x, normal);
    made.faces.push_back(static_cast<std::uint32_t>(f));
  }
  made.points = board.take_points();
  return made;
}

}  // namespace umtet
