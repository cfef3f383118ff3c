#include "reconstruct/cloud/neighbours/morton_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "tests/support/clouds.h"

namespace umtet {
namespace {

std::vector<std::uint32_t> shuffled(std::size_t n) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(7));
  return order;
}

double length_along(const std::vector<Vec3>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

TEST(MortonOrder, EveryPointOnceAndTheNextOneNear) {
  OrientedPointCloud cloud = test::torus_cloud(20000);
  std::vector<std::uint32_t> order = morton_order(cloud.points);
  const double before = length_along(cloud.points);
  sort_in_space(cloud);
  EXPECT_LT(length_along(cloud.points), .03 * before);
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
}

TEST(MortonOrder, IsTheSameHoweverPointsCome) {
  OrientedPointCloud cloud = test::torus_cloud(5000);
  // Of one cell: nearer to each other than 2^-21 of the box.
  for (int i = 0; i < 50; ++i) {
    cloud.points.emplace_back(cloud.points[i] + Vec3(1e-9, -1e-10, 0));
    cloud.normals.push_back(cloud.normals[i]);
  }
  for (std::size_t i = 0; i < cloud.points.size(); ++i) cloud.labels.push_back(static_cast<int>(i));
  OrientedPointCloud other;
  for (const std::uint32_t i : shuffled(cloud.points.size())) {
    other.points.push_back(cloud.points[i]);
    other.normals.push_back(cloud.normals[i]);
    other.labels.push_back(cloud.labels[i]);
  }
  sort_in_space(cloud);
  sort_in_space(other);
  EXPECT_EQ(other.points, cloud.points);
  EXPECT_EQ(other.normals, cloud.normals);
  EXPECT_EQ(other.labels, cloud.labels);
}

TEST(MortonOrder, AtOnePlaceTheFirstStaysFirst) {
  OrientedPointCloud cloud;
  cloud.points = {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {0, 0, 0}};
  cloud.labels = {0, 1, 2, 3};
  sort_in_space(cloud);
  EXPECT_EQ(cloud.labels, (std::vector<int>{1, 3, 0, 2}));
  EXPECT_TRUE(cloud.normals.empty());
}

TEST(MortonOrder, TakesWhatIsNoPlace) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const double x : {kNan, kInfinity, -kInfinity, 1e308, -1e308}) {
    std::vector<Vec3> points = test::torus_cloud(100).points;
    points[3][1] = x;
    points[60] = Vec3::Constant(-x);
    std::vector<std::uint32_t> order = morton_order(points);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(order.size(), points.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  }
  EXPECT_TRUE(morton_order({}).empty());
  EXPECT_EQ(morton_order({{kNan, 0, 0}}).size(), 1U);
}

}  // namespace
}  // namespace umtet
