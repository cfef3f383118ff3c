#include "reconstruct/cloud/normals/lines_of_sight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "reconstruct/cloud/normals/scanner_positions.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

bool asked(const OrientedPointCloud& cloud) {
  const Neighbourhoods near(cloud.points);
  return are_lines_of_sight(cloud, near, covering(cloud.points, near));
}

/// The nearest to x of twelve places around the body, three radii away.
Vec3 scanner_of(const Vec3& x) {
  Vec3 best = Vec3::Zero();
  for (int k = 0; k < 12; ++k) {
    const Vec3 place(3 * std::cos(k * .5236), 3 * std::sin(k * .5236), k % 2 == 0 ? 1.5 : -1.5);
    if (k == 0 || (place - x).squaredNorm() < (best - x).squaredNorm()) best = place;
  }
  return best;
}

OrientedPointCloud with_sights(OrientedPointCloud cloud) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.normals[i] = (scanner_of(cloud.points[i]) - cloud.points[i]).normalized();
  return cloud;
}

OrientedPointCloud with_noise(OrientedPointCloud cloud, double on_points, double on_normals) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> gauss;
  const auto noise = [&](double size) { return Vec3(size * Vec3(gauss(random), gauss(random), gauss(random))); };
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    cloud.points[i] += noise(on_points);
    cloud.normals[i] = (cloud.normals[i] + noise(on_normals)).normalized();
  }
  return cloud;
}

TEST(LinesOfSight, NormalsAreNone) {
  EXPECT_FALSE(asked(test::torus_cloud(3000)));
  EXPECT_FALSE(asked(with_noise(test::torus_cloud(3000), 0, .15)));
  EXPECT_FALSE(asked(test::box_cloud(Vec3(1, .7, .02), .02)));
  EXPECT_FALSE(asked(test::ball_in_lines(.07, 10)));
  OrientedPointCloud inward = test::torus_cloud(3000);
  for (Vec3& n : inward.normals) n = -n;
  EXPECT_FALSE(asked(inward));
}

TEST(LinesOfSight, DirectionsToAScannerAre) {
  EXPECT_TRUE(asked(with_sights(test::torus_cloud(3000))));
  EXPECT_TRUE(asked(with_sights(test::ball_in_lines(.07, 10))));
  OrientedPointCloud upward = test::torus_cloud(3000);
  for (Vec3& n : upward.normals) n = Vec3::UnitZ();
  EXPECT_TRUE(asked(upward));
}

TEST(LinesOfSight, PositionsThatDoNotTellAreNoReason) {
  EXPECT_FALSE(asked(with_noise(with_sights(test::torus_cloud(3000)), .05, 0)));
}

TEST(LinesOfSight, ArraysOfOtherLengthsAreRefused) {
  OrientedPointCloud cloud = test::torus_cloud(100);
  const Neighbourhoods near(cloud.points);
  cloud.normals.pop_back();
  EXPECT_THROW(are_lines_of_sight(cloud, near, {}), std::invalid_argument);
}

TEST(OrientToOrigins, TurnsAllOrThoseThatLookAway) {
  const OrientedPointCloud truth = test::torus_cloud(3000);
  OrientedPointCloud cloud = truth;
  for (const Vec3& x : truth.points) cloud.origins.push_back(scanner_of(x));
  // As seen from there; the torus hides parts of itself, which the nearest scanner does not know.
  std::size_t n_away = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    Vec3& n = cloud.normals[i];
    if (n.dot(cloud.origins[i] - cloud.points[i]) < 0) cloud.origins[i] = cloud.points[i] + n;
    n = -n;
  }
  const std::vector<Vec3> right = [&] {
    std::vector<Vec3> all = cloud.normals;
    for (Vec3& n : all) n = -n;
    return all;
  }();
  EXPECT_EQ(share_looking_away(cloud), 1);
  EXPECT_EQ(orient_to_origins(cloud), cloud.points.size());
  EXPECT_EQ(cloud.normals, right);
  for (std::size_t i = 0; i < 200; ++i) {
    const bool is_grazing = right[i].dot((cloud.origins[i] - cloud.points[i]).normalized()) < .5;
    if (!is_grazing) ++n_away, cloud.normals[i] = -cloud.normals[i];
  }
  EXPECT_EQ(orient_to_origins(cloud), n_away);
  EXPECT_EQ(cloud.normals, right);
}

TEST(OrientToOrigins, AGrazingLookIsNoProof) {
  OrientedPointCloud plane = test::plane_cloud(10, Vec3::UnitZ());
  plane.origins.assign(plane.points.size(), Vec3(0, 0, 1));
  plane.normals[0] = Vec3(1, 0, -.2).normalized();
  plane.origins[0] = plane.points[0] + Vec3::UnitZ();
  plane.origins[1] = Vec3::Constant(std::numeric_limits<double>::infinity());
  const std::vector<Vec3> before = plane.normals;
  EXPECT_EQ(orient_to_origins(plane), 0);
  EXPECT_EQ(plane.normals, before);
}

}  // namespace
}  // namespace umtet
