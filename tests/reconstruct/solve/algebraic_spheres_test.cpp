#include "reconstruct/solve/algebraic_spheres.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace umtet {
namespace {

std::vector<Vec3> directions(int n) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3> d;
  for (int i = 0; i < n; ++i) d.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
  return d;
}

TEST(AlgebraicSpheres, APartOfASphereGivesTheDistanceToAllOfIt) {
  const Vec3 centre(3, -1, 2);
  std::vector<Vec3> points, normals;
  for (const Vec3& d : directions(4000)) {
    if (d[2] < .2) continue;  // 40 % are left
    points.push_back(centre + 1.5 * d);
    normals.push_back(d);
  }
  const AlgebraicSpheres spheres(points, normals, std::vector<double>(points.size(), .3));
  for (const Vec3& d : directions(50))
    for (const double r : {.1, .9, 1.7, 4.}) EXPECT_NEAR(spheres.signed_distance(centre + r * d), r - 1.5, 1e-9) << r;
}

TEST(AlgebraicSpheres, APlaneGivesTheDistanceToIt) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> side(-1, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(side(random), side(random), .25);
  const AlgebraicSpheres spheres(points, std::vector<Vec3>(points.size(), Vec3(0, 0, 1)),
                                 std::vector<double>(points.size(), 1));
  for (const double z : {-.5, .1, .8}) EXPECT_NEAR(spheres.signed_distance({.3, -.2, z}), z - .25, 1e-9);
}

TEST(AlgebraicSpheres, RefusesNumbersThatDoNotMatch) {
  const std::vector<Vec3> one(1, Vec3::Zero());
  EXPECT_THROW(AlgebraicSpheres({}, {}, {}), std::invalid_argument);
  EXPECT_THROW(AlgebraicSpheres(one, {}, {1.}), std::invalid_argument);
  EXPECT_THROW(AlgebraicSpheres(one, one, {}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
