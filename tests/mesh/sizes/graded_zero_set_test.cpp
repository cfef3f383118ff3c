#include "mesh/sizes/graded_zero_set.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh/implicit/cut_tets.h"
#include "tests/support/values.h"

namespace umtet {
namespace {

using testing::Values;

Box cube(double half) { return {Vec3::Constant(-half), Vec3::Constant(half)}; }

/// h everywhere but around one place.
SizeField spot(const Vec3& x, double h_there, double h) {
  return {{{x, h_there, 2 * h_there}}, {.grade = .3, .h_min = h_there, .h_max = h}};
}

const Values kTorus{[](const Vec3& x) { return std::hypot(std::hypot(x.x(), x.y()) - 1, x.z()) - .4; }};
constexpr double kTorusArea = 4 * std::numbers::pi * std::numbers::pi * .4;

TEST(GradedZeroSet, OfATorusFineOnOneSideHasItsTopologyAndArea) {
  const SizeField sizes = spot({1.4, 0, 0}, .02, .16);
  const ZeroSetTopology z = graded_zero_set(kTorus, cube(1.6), sizes, 1, .02, 1);
  ASSERT_EQ(z.components.size(), 1u);
  EXPECT_EQ(z.components[0].genus, 1);
  EXPECT_TRUE(z.components[0].closed);
  EXPECT_NEAR(z.components[0].area, kTorusArea, .03 * kTorusArea);
  EXPECT_NEAR(std::accumulate(z.cut_areas.begin(), z.cut_areas.end(), 0.), z.components[0].area, 1e-9);
  EXPECT_EQ(z.cut_points.size(), z.cut_areas.size());
  EXPECT_LE(std::sqrt(3.) * z.spacing, kLongestCountedEdge * .16);
  // Most points are where edges are short, and yet each stands for its part of the surface.
  double area = 0, n = 0;
  for (std::size_t i = 0; i < z.cut_points.size(); ++i) {
    if (z.cut_points[i].x() > 0) area += z.cut_areas[i], ++n;
  }
  EXPECT_GT(n, .6 * static_cast<double>(z.cut_points.size()));
  EXPECT_NEAR(area, kTorusArea / 2, .03 * kTorusArea);
}

TEST(GradedZeroSet, CubesThatAreLeftOutByTheSlopeChangeNothing) {
  const SizeField sizes = spot({1.4, 0, 0}, .03, .16);
  const ZeroSetTopology all = graded_zero_set(kTorus, cube(1.6), sizes, 1, .03);
  const ZeroSetTopology some = graded_zero_set(kTorus, cube(1.6), sizes, 1, .03, 1);
  EXPECT_EQ(some.euler_characteristic, all.euler_characteristic);
  EXPECT_EQ(some.cut_points.size(), all.cut_points.size());
  EXPECT_NEAR(some.components.at(0).area, all.components.at(0).area, 1e-12);
}

TEST(GradedZeroSet, WhatIsSmallShowsWhereEdgesAreShort) {
  const Vec3 at(.9, .05, .02);
  const Values balls{[&](const Vec3& x) { return std::min(x.norm() - .5, (x - at).norm() - .02); }};
  const ZeroSetTopology both = graded_zero_set(balls, cube(1.3), spot(at, .01, .2), 1, .01, 1);
  EXPECT_EQ(both.components.size(), 2u);
  EXPECT_EQ(both.euler_characteristic, 4);
  // Halves of the sizes see what is half as large.
  const Values smaller{[&](const Vec3& x) { return std::min(x.norm() - .5, (x - at).norm() - .005); }};
  EXPECT_EQ(graded_zero_set(smaller, cube(1.3), spot(at, .01, .2), .25, .01, 1).components.size(), 2u);
}

TEST(GradedZeroSet, BanchoffChmutovSurfacesHaveTheirGenus) {
  // T_4(x) + T_4(y) + T_4(z) = 0: genus 5.
  const Values psi{[](const Vec3& x) {
    double sum = 0;
    for (const double c : x) sum += 8 * c * c * (c * c - 1) + 1;
    return sum;
  }};
  const ZeroSetTopology z = graded_zero_set(psi, cube(1.3), spot({1, 1, 1}, .02, .06), 1, .02);
  ASSERT_EQ(z.components.size(), 1u);
  EXPECT_EQ(z.components[0].genus, 5);
}

TEST(GradedZeroSet, ASurfaceThatLeavesTheBoxIsNotClosed) {
  // A torus without a disk on one side of it: chi drops by one.
  const Box box(Vec3(-1.2, -1.6, -1.6), Vec3(2, 1.6, 1.6));  // a cube, so that the root cube is the box
  const double width = .1 / kBccMeanEdge;
  const Box fitted(box.min(), box.min() + Vec3::Constant(32 * width));
  const ZeroSetTopology z = graded_zero_set(kTorus, fitted, spot({1.4, 0, 0}, .1, .1), 1, .1);
  ASSERT_EQ(z.components.size(), 1u);
  EXPECT_FALSE(z.components[0].closed);
  EXPECT_EQ(z.components[0].euler_characteristic, -1);
}

TEST(GradedZeroSet, DoesNotDependOnTheNumberOfThreads) {
  ZeroSetTopology result[2];
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    result[threads - 1] = graded_zero_set(kTorus, cube(1.6), spot({1.4, 0, 0}, .03, .16), 1, .03);
  }
  EXPECT_EQ(result[0].cut_points, result[1].cut_points);
  EXPECT_EQ(result[0].cut_areas, result[1].cut_areas);
}

TEST(CutTets, WhatIsNoNumberCountsAsOutside) {
  const CutTets one{.x = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                    .psi = {-1, std::nan(""), 1, 1},
                    .on_boundary = {0, 0, 0, 0},
                    .tets = {{0, 1, 2, 3}}};
  const ZeroSetTopology z = zero_set_topology(one);
  EXPECT_EQ(z.n_not_finite, 1u);
  ASSERT_EQ(z.cut_points.size(), 3u);
  for (const Vec3& x : z.cut_points) EXPECT_TRUE(x.allFinite());
}

}  // namespace
}  // namespace umtet
