#include "mesh/features/feature_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/piecewise_bodies.h"

namespace umtet {
namespace {

using testing::piecewise_body;
using testing::PiecewiseBody;
using testing::random_placement;

/// A grid of points with spacing h that covers a body.
std::vector<Vec3> seeds_around(const PiecewiseBody& body, double h) {
  std::vector<Vec3> seeds;
  const double R = body.radius + 2 * h;
  for (double x = -R; x < R; x += h)
    for (double y = -R; y < R; y += h)
      for (double z = -R; z < R; z += h) seeds.emplace_back(x, y, z);
  return seeds;
}

TEST(FeatureGraph, HasEveryCurveAndCornerOfABodyInAnyPosition) {
  for (const char* name : {"cube", "cylinder", "L", "lens", "balls", "cube-ball", "wedge60", "wedge30"}) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(std::string(name) + ", seed " + std::to_string(seed));
      const double h = .25;
      const PiecewiseBody body = piecewise_body(name, random_placement(seed, h));
      const FeatureGraph graph = trace_features(body.domain, seeds_around(body, h), h);
      EXPECT_TRUE(graph.defects.empty());
      EXPECT_EQ(graph.corners.size(), static_cast<std::size_t>(body.corners));
      EXPECT_EQ(graph.curves.size(), static_cast<std::size_t>(body.curves));
      double length = 0, least = 360;
      for (const FeatureCurve& c : graph.curves) {
        length += c.length();
        least = std::min(least, *std::min_element(c.angle_deg.begin(), c.angle_deg.end()));
        for (const Vec3& x : c.points)
          for (const int p : c.patches) EXPECT_NEAR(body.domain.patch(p, x), 0, 1e-11);
      }
      // Chords of .2 h are shorter than their arcs.
      EXPECT_NEAR(length, body.curve_length, 2e-3 * body.curve_length);
      EXPECT_NEAR(least, body.least_angle_deg, 1e-6);
      for (const FeatureCorner& c : graph.corners)
        for (const int p : c.patches) EXPECT_NEAR(body.domain.patch(p, c.place), 0, 1e-11);
    }
  }
}

TEST(FeatureGraph, FourPlanesThroughAPointAreOneCorner) {
  // A pyramid over a square.
  const testing::Placement at = random_placement(1, .2);
  PiecewiseDomain pyramid = testing::half_space(at, {0, 0, -1}, 0);
  for (const Vec3& n : {Vec3(1, 0, 1), Vec3(-1, 0, 1), Vec3(0, 1, 1), Vec3(0, -1, 1)})
    pyramid = intersection(pyramid, testing::half_space(at, n, 1 / std::sqrt(2.)));
  const FeatureGraph graph = trace_features(pyramid, seeds_around({"", pyramid, 1.6, 0, true, 5, 8, 0, 0}, .25), .25);
  EXPECT_TRUE(graph.defects.empty());
  ASSERT_EQ(graph.corners.size(), 5U);
  EXPECT_EQ(graph.curves.size(), 8U);
  const auto n_of_four = std::count_if(graph.corners.begin(), graph.corners.end(),
                                       [](const FeatureCorner& c) { return c.patches.size() == 4; });
  EXPECT_EQ(n_of_four, 1);
}

TEST(FeatureGraph, TouchingPatchesAreReportedAndNeverFollowed) {
  // The plane touches the ball, as a cylinder in a slab of its own width would.
  const PiecewiseDomain domain =
      intersection(testing::ball_at({}, {0, 0, 0}, 1), testing::half_space({}, {0, 0, 1}, 1));
  const FeatureGraph graph = trace_features(domain, {{0, 0, 1.1}, {.1, .2, .9}}, .25);
  EXPECT_TRUE(graph.curves.empty());
}

TEST(FeatureGraph, ACurveThatLeavesTheSeedsBehindForEverIsADefect) {
  const PiecewiseDomain wedge =
      intersection(testing::half_space({}, {1, 0, 0}, 0), testing::half_space({}, {0, 1, 0}, 0));
  const FeatureGraph graph = trace_features(wedge, {{.1, .1, 0}}, .25);
  EXPECT_TRUE(graph.curves.empty());
  ASSERT_EQ(graph.defects.size(), 1U);
  EXPECT_EQ(graph.defects[0].kind, FeatureDefect::Kind::NotTraced);
}

}  // namespace
}  // namespace umtet
