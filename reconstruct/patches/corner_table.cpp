#include "reconstruct/patches/corner_table.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace umtet {
namespace {

// Directions that are looked at: on average 30 in each of the 58 cells of eight planes.
constexpr int kDirections = 2000;
constexpr std::size_t kMostPatches = 8;

/// A sector of the fan: directions cos(t) from + sin(t) across, 0 <= t <= angle.
struct Sector {
  Vec3 normal, from, across;
  double angle;
};

/// Points spread evenly over the sphere, on a spiral [Swinbank2006].
Vec3 direction(int k) {
  const double z = 1 - (2 * k + 1.) / kDirections, r = std::sqrt(1 - z * z);
  const double turn = k * std::numbers::pi * (3 - std::sqrt(5.));
  return {r * std::cos(turn), r * std::sin(turn), z};
}

/// The sector of a patch between its two rays. It is on the inner side of the other patch of a convex ray.
Sector sector_of(int patch, const std::vector<Vec3>& normals, const CornerRay& first, const CornerRay& second) {
  const Vec3& n = normals[patch];
  const auto in_plane = [&](const Vec3& t) { return Vec3((t - t.dot(n) * n).normalized()); };
  Sector s{n, in_plane(first.direction), Vec3::Zero(), 0};
  s.across = n.cross(s.from);
  const int other = first.patches[0] == patch ? first.patches[1] : first.patches[0];
  if ((normals[other].dot(s.across) < 0) != first.is_convex) s.across = -s.across;
  const Vec3 end = in_plane(second.direction);
  s.angle = std::atan2(end.dot(s.across), end.dot(s.from));
  if (s.angle < 0) s.angle += 2 * std::numbers::pi;
  return s;
}

/// Whether a direction is inside, by the nearest point of the fan.
bool is_inside(const Vec3& u, const std::vector<Sector>& sectors, const std::vector<Vec3>& normals,
               const std::vector<CornerRay>& rays) {
  double nearest = -std::numeric_limits<double>::infinity();  // cosine
  bool inside = false;
  for (const Sector& s : sectors) {
    double t = std::atan2(u.dot(s.across), u.dot(s.from));
    if (t < 0) t += 2 * std::numbers::pi;
    const double height = u.dot(s.normal), cosine = std::sqrt(std::max(0., 1 - height * height));
    if (t > s.angle || cosine <= nearest) continue;
    nearest = cosine;
    inside = height < 0;
  }
  for (const CornerRay& ray : rays) {
    const double cosine = u.dot(ray.direction);
    if (cosine <= nearest) continue;
    nearest = cosine;
    const double a = normals[ray.patches[0]].dot(u), b = normals[ray.patches[1]].dot(u);
    inside = (ray.is_convex ? std::max(a, b) : std::min(a, b)) < 0;
  }
  return inside;
}

}  // namespace

std::vector<std::uint32_t> corner_terms(const std::vector<Vec3>& normals, const std::vector<CornerRay>& rays) {
  const std::size_t k = normals.size();
  if (k < 3 || k > kMostPatches) return {};
  std::vector<Sector> sectors;
  for (std::size_t p = 0; p < k; ++p) {
    std::vector<const CornerRay*> own;
    for (const CornerRay& ray : rays)
      if (ray.patches[0] == static_cast<int>(p) || ray.patches[1] == static_cast<int>(p)) own.push_back(&ray);
    if (own.size() != 2) return {};
    sectors.push_back(sector_of(static_cast<int>(p), normals, *own[0], *own[1]));
  }
  // How clearly the directions with each set of negative signs are outside.
  std::vector<double> outside(std::size_t{1} << k, 0);
  for (int d = 0; d < kDirections; ++d) {
    const Vec3 u = direction(d);
    std::uint32_t negative = 0;
    double clear = 1;
    for (std::size_t p = 0; p < k; ++p) {
      const double f = normals[p].dot(u);
      if (f < 0) negative |= 1u << p;
      clear = std::min(clear, std::abs(f));
    }
    outside[negative] += is_inside(u, sectors, normals, rays) ? -clear : clear;
  }
  std::vector<std::uint32_t> terms;
  for (std::uint32_t set = 1; set < outside.size(); ++set) {
    bool is_term = true;
    for (std::uint32_t other = 0; other < outside.size() && is_term; ++other)
      is_term = (other & set) != set || outside[other] <= 0;
    if (is_term) terms.push_back(set);
  }
  const auto has_smaller = [&](std::uint32_t set) {
    return std::any_of(terms.begin(), terms.end(), [&](std::uint32_t t) { return t != set && (t & set) == t; });
  };
  std::vector<std::uint32_t> prime;
  for (const std::uint32_t set : terms)
    if (!has_smaller(set)) prime.push_back(set);
  return prime;
}

}  // namespace umtet
