#include "reconstruct/cloud/neighbours/neighbour_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"

namespace umtet {
namespace {

std::vector<Vec3> clumps(int n) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(std::exp(3 * gauss(random)), gauss(random), (i % 7) + 1e-3 * gauss(random));
  for (int i = 0; i < n / 10; ++i) points.push_back(points[static_cast<std::size_t>(3 * i)]);  // duplicates
  points.emplace_back(1e9, 0, 0);
  return points;
}

// Sizes around the 16 points of a leaf of FLANN's tree, and k around all of them.
TEST(NeighbourTree, FindsWhatAllPairsFind) {
  for (const int n : {1, 5, 15, 16, 17, 100, 700}) {
    const std::vector<Vec3> points = clumps(n);
    const NeighbourTree tree(points);
    for (const std::size_t k : {std::size_t{1}, std::size_t{4}, std::size_t{13}, std::size_t{60}, std::size_t{2000}}) {
      std::vector<int> visits(points.size(), 0);
      tree.for_each_neighbourhood(k, [&](std::uint32_t i, std::span<const Neighbour> near) {
        ++visits[i];
        std::vector<double> all;
        for (const Vec3& x : points) all.push_back((x - points[i]).squaredNorm());
        std::sort(all.begin(), all.end());
        ASSERT_EQ(near.size(), std::min(k, points.size()));
        std::vector<std::uint32_t> ids;
        for (std::size_t m = 0; m < near.size(); ++m) {
          EXPECT_NEAR(near[m].distance2, all[m], 1e-14 * all[m]);
          EXPECT_NEAR(near[m].distance2, (points[near[m].point] - points[i]).squaredNorm(), 1e-14 * all[m]);
          EXPECT_EQ(near[m].distance2, squared_distance(points[i], points[near[m].point]));
          ids.push_back(near[m].point);
        }
        std::sort(ids.begin(), ids.end());
        EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
      });
      EXPECT_EQ(visits, std::vector<int>(points.size(), 1));
    }
  }
}

TEST(Neighbourhoods, AreTheNearestOthers) {
  for (const int n : {2, 12, 13, 14, 700}) {
    std::vector<Vec3> points = clumps(n);
    points.insert(points.end(), 20, points.back());  // more at a place than neighbours are asked for
    const Neighbourhoods near(points);
    ASSERT_EQ(near.k(), 12U);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      std::vector<double> all;
      for (std::uint32_t j = 0; j < points.size(); ++j)
        if (j != i) all.push_back((points[j] - points[i]).squaredNorm());
      std::sort(all.begin(), all.end());
      EXPECT_FALSE(near.has(i, i));
      for (std::size_t m = 0; m < near.k(); ++m) {
        EXPECT_NEAR(near.distance2(points, i, m), all[m], 1e-14 * all[m]);
        EXPECT_TRUE(near.has(i, near.points(i)[m]));
      }
    }
  }
  EXPECT_EQ(Neighbourhoods({Vec3::Zero(), Vec3::UnitX()}).k(), 1U);
}

// A lattice is all ties, on both sides of every cut: any k of them would be nearest, and the least numbers are asked
// for.
TEST(NeighbourTree, EqualDistancesComeByPointNumber) {
  std::vector<Vec3> points;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j)
      for (int l = 0; l < 9; ++l) points.emplace_back(i, j, l);
  std::shuffle(points.begin(), points.end(), std::mt19937_64(4));
  const NeighbourTree tree(points);
  tree.for_each_neighbourhood(13, [&](std::uint32_t i, std::span<const Neighbour> near) {
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::uint32_t j = 0; j < points.size(); ++j) all.emplace_back((points[j] - points[i]).squaredNorm(), j);
    std::sort(all.begin(), all.end());
    for (std::size_t m = 0; m < near.size(); ++m) EXPECT_EQ(std::pair(near[m].distance2, near[m].point), all[m]);
  });
}

// Large clouds have several trees.
TEST(NeighbourTree, FindsWhatAllPairsFindInLargeClouds) {
  const std::vector<Vec3> points = clumps(150000);
  const NeighbourTree tree(points);
  std::vector<Neighbour> room(9);
  for (std::size_t i = 0; i < points.size(); i += 4999) {
    const Vec3 x = points[i] + Vec3(.1, -.05, .02);
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::uint32_t j = 0; j < points.size(); ++j) all.emplace_back((points[j] - x).squaredNorm(), j);
    std::partial_sort(all.begin(), all.begin() + 9, all.end());
    const std::span<const Neighbour> near = tree.k_nearest(x, room);
    ASSERT_EQ(near.size(), 9U);
    for (std::size_t m = 0; m < near.size(); ++m) {
      EXPECT_NEAR(near[m].distance2, all[m].first, 1e-12 * all[m].first);
      EXPECT_NEAR((points[near[m].point] - x).squaredNorm(), all[m].first, 1e-12 * all[m].first);
    }
    const double radius2 = 1.5 * all[8].first;
    const auto expected = static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [&](const auto& a) { return a.first <= radius2; }));
    EXPECT_EQ(tree.count_within(x, radius2, points.size()), expected);
    EXPECT_EQ(tree.count_within(x, radius2, 3), 3U);
  }
}

TEST(NeighbourTree, NearInTheOrderIsNearInSpace) {
  std::vector<Vec3> points = clumps(3000);
  points.pop_back();  // the one far away
  const NeighbourTree tree(points);
  std::vector<std::uint32_t> order = tree.order();
  double along = 0, shuffled = 0;
  for (std::size_t row = 1; row < order.size(); ++row) {
    along += (points[order[row]] - points[order[row - 1]]).norm();
    shuffled += (points[row] - points[row - 1]).norm();
  }
  EXPECT_LT(along, 0.2 * shuffled);
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

TEST(NeighbourTree, CountsAndVisitsTheSameBall) {
  const std::vector<Vec3> points = clumps(2000);
  const NeighbourTree tree(points);
  for (const double radius : {0.0, 0.1, 1.0, 30.0, 1e10}) {
    std::size_t expected = 0, visited = 0;
    for (const Vec3& x : points) expected += (x - points[5]).squaredNorm() <= radius * radius ? 1 : 0;
    tree.within(points[5], radius * radius, [&](std::uint32_t, double) { ++visited; });
    EXPECT_EQ(visited, expected);
    EXPECT_EQ(tree.count_within(points[5], radius * radius, 1000000), expected);
    EXPECT_EQ(tree.count_within(points[5], radius * radius, 3), std::min<std::size_t>(3, expected));
  }
}

TEST(NeighbourTree, TheFirstAlongARayIsTheNearestOfThoseAccepted) {
  const std::vector<Vec3> points = clumps(3000);
  const NeighbourTree tree(points);
  std::mt19937_64 random(8);
  std::normal_distribution<double> gauss;
  for (int ray = 0; ray < 100; ++ray) {
    Vec3 d = Vec3(gauss(random), gauss(random), gauss(random)).normalized();
    if (ray < 3) d = Vec3::Unit(ray);  // along an axis: divisions by zero
    const Vec3& x = points[static_cast<std::size_t>(7 * ray)];
    const auto accept = [](std::uint32_t i) { return i % 3 != 0; };
    double first = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const Vec3 r = points[i] - x;
      const double t = r.dot(d);
      if (accept(i) && t >= 0.01 && (r - t * d).norm() <= 0.2) first = std::min(first, t);
    }
    EXPECT_EQ(tree.first_along(x, d, 0.01, 0.2, accept).t, first);
  }
}

TEST(NeighbourTree, RefusesWhatHasNoPlace) {
  EXPECT_THROW(NeighbourTree({}), std::invalid_argument);
  EXPECT_THROW(NeighbourTree({Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)}), std::invalid_argument);
  EXPECT_THROW(NeighbourTree({Vec3::Zero(), Vec3(0, 1e154, 0)}), std::invalid_argument);
  const NeighbourTree tree({Vec3::Zero(), Vec3(-1e153, 1e153, 0)});
  EXPECT_EQ(tree.count_within(Vec3::Zero(), 2.1e306, 3), 2U);
  EXPECT_THROW(tree.for_each_neighbourhood(0, [](std::uint32_t, std::span<const Neighbour>) {}), std::invalid_argument);
  EXPECT_THROW(tree.first_along(Vec3::Zero(), Vec3::UnitX(), 0, 0, [](std::uint32_t) { return true; }),
               std::invalid_argument);
  EXPECT_EQ(tree.first_along(Vec3::Zero(), Vec3::Zero(), 0, 1, [](std::uint32_t) { return true; }).t,
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace umtet
