#include "reconstruct/patches/corner_table.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace umtet {
namespace {

/// A cone over a polygon on the sphere that is star-shaped around the z axis. It is convex or not.
struct Cone {
  std::vector<Vec3> rays, normals;
  std::vector<CornerRay> corner;

  Cone(int k, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<double> azimuth;
    do {
      azimuth.clear();
      for (int i = 0; i < k; ++i) azimuth.push_back(2 * std::numbers::pi * unit(random));
      std::sort(azimuth.begin(), azimuth.end());
    } while (!is_spread(azimuth));
    for (const double a : azimuth) {
      const double polar = .4 + 1.9 * unit(random);
      rays.emplace_back(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar));
    }
    for (int i = 0; i < k; ++i) normals.push_back(-ray(i).cross(ray(i + 1)).normalized());
    for (int i = 0; i < k; ++i) {
      const int before = (i + k - 1) % k;
      corner.push_back({ray(i), {before, i}, normals[before].dot(ray(i + 1)) < 0});
    }
  }
  const Vec3& ray(int i) const { return rays[static_cast<std::size_t>(i) % rays.size()]; }
  /// Gaps between azimuths of 20 to 170 degrees: the z axis is inside.
  static bool is_spread(const std::vector<double>& azimuth) {
    for (std::size_t i = 0; i < azimuth.size(); ++i) {
      const double next = i + 1 < azimuth.size() ? azimuth[i + 1] : azimuth[0] + 2 * std::numbers::pi;
      if (next - azimuth[i] < .35 || next - azimuth[i] > 2.97) return false;
    }
    return true;
  }
  /// Whether every plane that is a side of the polygon keeps it away from the others by this sine at least.
  bool is_clear() const {
    for (const CornerRay& r : corner)
      if (std::abs(normals[r.patches[0]].cross(normals[r.patches[1]]).norm()) < .2) return false;
    return true;
  }
  bool is_inside(const Vec3& u) const {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3 &a = rays[i], &b = ray(static_cast<int>(i) + 1);
      const auto turn = [](const Vec3& p, const Vec3& q) { return p.x() * q.y() - p.y() * q.x(); };
      if (turn(a, u) >= 0 && turn(u, b) > 0) return normals[i].dot(u) < 0;
    }
    return false;
  }
};

double psi(const std::vector<std::uint32_t>& terms, const std::vector<Vec3>& normals, const Vec3& u) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t term : terms) {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < normals.size(); ++p)
      if ((term >> p & 1) != 0) most = std::max(most, normals[p].dot(u));
    least = std::min(least, most);
  }
  return least;
}

TEST(CornerTable, HasTheSignOfAnyCone) {
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  int n_wrong = 0, n_cones = 0;
  for (int k = 3; k <= 6; ++k) {
    for (int made = 0; made < 200;) {
      const Cone cone(k, random);
      if (!cone.is_clear()) continue;
      ++made, ++n_cones;
      const std::vector<std::uint32_t> terms = corner_terms(cone.normals, cone.corner);
      ASSERT_FALSE(terms.empty());
      bool is_wrong = false;
      for (int d = 0; d < 500; ++d) {
        const Vec3 u = Vec3(gauss(random), gauss(random), gauss(random)).normalized();
        double clear = 1;
        for (const Vec3& n : cone.normals) clear = std::min(clear, std::abs(n.dot(u)));
        if (clear > .05) is_wrong |= (psi(terms, cone.normals, u) < 0) != cone.is_inside(u);
      }
      n_wrong += is_wrong ? 1 : 0;
    }
  }
  EXPECT_EQ(n_wrong, 0) << "of " << n_cones;
}

TEST(CornerTable, ACubeIsAMaximumAndANotchAMinimum) {
  const std::vector<Vec3> normals = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const std::vector<CornerRay> cube = {
      {-Vec3::UnitX(), {1, 2}, true}, {-Vec3::UnitY(), {0, 2}, true}, {-Vec3::UnitZ(), {0, 1}, true}};
  EXPECT_EQ(corner_terms(normals, cube), (std::vector<std::uint32_t>{7}));
  const std::vector<CornerRay> notch = {
      {Vec3::UnitX(), {1, 2}, false}, {Vec3::UnitY(), {0, 2}, false}, {Vec3::UnitZ(), {0, 1}, false}};
  EXPECT_EQ(corner_terms(normals, notch), (std::vector<std::uint32_t>{1, 2, 4}));
}

TEST(CornerTable, AFanThatIsNotClosedHasNone) {
  const std::vector<Vec3> normals = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  EXPECT_TRUE(corner_terms(normals, {{-Vec3::UnitX(), {1, 2}, true}, {-Vec3::UnitY(), {0, 2}, true}}).empty());
}

}  // namespace
}  // namespace umtet
