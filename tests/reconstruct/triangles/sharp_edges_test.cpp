#include "reconstruct/triangles/sharp_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

/// A surface of revolution around z: rings of n points at (radius, z), the first and the last closed by a fan.
TriangleMesh turned(int n, const std::vector<std::pair<double, double>>& profile) {
  TriangleMesh mesh;
  for (const auto& [r, z] : profile) {
    for (int i = 0; i < n; ++i) {
      const double a = 2 * M_PI * i / n;
      mesh.V.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
  }
  const int m = static_cast<int>(profile.size());
  for (int k = 0; k + 1 < m; ++k) {
    for (int i = 0; i < n; ++i) {
      const int a = k * n + i, b = k * n + (i + 1) % n;
      mesh.F.push_back({a, b, b + n});
      mesh.F.push_back({a, b + n, a + n});
    }
  }
  mesh.V.emplace_back(0, 0, profile.front().second);
  mesh.V.emplace_back(0, 0, profile.back().second);
  for (int i = 0; i < n; ++i) {
    mesh.F.push_back({m * n, (i + 1) % n, i});
    mesh.F.push_back({m * n + 1, (m - 1) * n + i, (m - 1) * n + (i + 1) % n});
  }
  return mesh;
}

TriangleMesh sphere(int n_around, int n_up, double noise = 0) {
  std::vector<std::pair<double, double>> profile;
  for (int k = 1; k < n_up; ++k) profile.emplace_back(std::sin(M_PI * k / n_up), -std::cos(M_PI * k / n_up));
  TriangleMesh mesh = turned(n_around, profile);
  mesh.V[mesh.V.size() - 2].z() = -1;
  mesh.V.back().z() = 1;
  std::mt19937 random(1);
  std::normal_distribution<double> normal(1, noise);
  if (noise > 0) {
    for (Vec3& x : mesh.V) x *= normal(random);
  }
  return mesh;
}

TEST(SharpEdges, ACubeHasTwelveEdgesEightCornersAndSixPatches) {
  const SharpEdges found = find_sharp_edges(test::cube());
  EXPECT_EQ(found.curves.size(), 12u);
  EXPECT_EQ(found.corners.size(), 8u);
  EXPECT_EQ(found.n_patches, 6u);
  const double side = (test::cube().V[1] - test::cube().V[0]).cwiseAbs().maxCoeff();
  EXPECT_NEAR(found.length(), 12 * side, 1e-12);
}

TEST(SharpEdges, VerticesOfAnStlAreIdentified) {
  const SharpEdges found = find_sharp_edges(test::split(test::cube(), 0));
  EXPECT_EQ(found.curves.size(), 12u);
  EXPECT_EQ(found.n_patches, 6u);
}

TEST(SharpEdges, ACylinderHasTwoRimsForAnyNumberOfFacets) {
  for (const int n : {8, 12, 24, 48, 96}) {
    for (const double height : {.3, 2., 10.}) {
      const SharpEdges found = find_sharp_edges(turned(n, {{1, 0}, {1, height}}));
      ASSERT_EQ(found.curves.size(), 2u) << n << " facets, height " << height;
      EXPECT_TRUE(found.curves[0].is_closed() && found.curves[1].is_closed());
      EXPECT_TRUE(found.corners.empty());
      EXPECT_EQ(found.n_patches, 3u);
      EXPECT_NEAR(found.length(), 4 * n * std::sin(M_PI / n), 1e-9);
    }
  }
}

TEST(SharpEdges, SpheresHaveNone) {
  for (const auto& [around, up] : {std::pair{8, 7}, {12, 8}, {24, 12}, {60, 50}}) {
    for (const double noise : {0., .0005}) {
      const SharpEdges found = find_sharp_edges(sphere(around, up, noise));
      EXPECT_TRUE(found.curves.empty()) << around << " around, noise " << noise << ": " << found.length();
      EXPECT_EQ(found.n_patches, 1u);
    }
  }
}

TEST(SharpEdges, ATorusHasNone) { EXPECT_TRUE(find_sharp_edges(test::torus()).curves.empty()); }

TEST(SharpEdges, ABevelOf45DegreesIsAPatch) {
  // A cylinder of many facets: its bevel turns by 45 degrees twice, at distances that differ much from those beside it.
  const SharpEdges found = find_sharp_edges(turned(64, {{1, 0}, {1, 2}, {.9, 2.1}}));
  EXPECT_EQ(found.curves.size(), 3u);
  EXPECT_EQ(found.n_patches, 4u);
}

TEST(SharpEdges, AHexagonalPrismHasEighteenEdges) {
  const SharpEdges found = find_sharp_edges(turned(6, {{1, 0}, {1, 1}}));
  EXPECT_EQ(found.curves.size(), 18u);
  EXPECT_EQ(found.corners.size(), 12u);
  EXPECT_EQ(found.n_patches, 8u);
}

TEST(SharpEdges, SpecksAreNoise) {
  TriangleMesh mesh = sphere(60, 50);
  mesh.V[700] *= 1.05;  // one vertex sticks out: its edges are loose and short
  EXPECT_TRUE(find_sharp_edges(mesh).curves.empty());
}

// The outline of a box with a chamfer along z: its curves turn by 45 degrees twice, between longer edges.
TEST(SharpEdges, ACurveHasKinksAtAChamferAndNoneOnAnArc) {
  const SharpEdges chamfer = find_sharp_edges(test::prism({{0, 0}, {2, 0}, {2, .7}, {1.5, 1.2}, {0, 1.2}}, 1));
  EXPECT_EQ(chamfer.corners.size(), 10u);
  // A quarter of a circle of eight chords is no kink.
  std::vector<Eigen::Vector2d> round = {{0, 0}, {2, 0}};
  for (int k = 0; k <= 8; ++k) round.emplace_back(1 + std::cos(k * M_PI / 16), .2 + std::sin(k * M_PI / 16));
  round.emplace_back(0, 1.2);
  const SharpEdges arc = find_sharp_edges(test::prism(round, 1));
  EXPECT_EQ(arc.corners.size(), 6u);
}

TEST(SharpEdges, BordersOfLabelsAndLinesAreCurvesInAPlane) {
  TriangleMesh mesh = test::cube_with_imprint();
  const SharpEdges both = find_sharp_edges(mesh);
  EXPECT_EQ(both.curves.size(), 16u);
  EXPECT_EQ(both.n_curves_by(SharpCurve::Reason::Border), 4u);
  EXPECT_EQ(both.n_curves_by(SharpCurve::Reason::Turn), 12u);
  EXPECT_EQ(both.n_patches, 7u);
  EXPECT_EQ(both.corners.size(), 12u);
  EXPECT_EQ(find_sharp_edges(mesh, {.by_turn = false}).curves.size(), 4u);
  EXPECT_EQ(find_sharp_edges(mesh, {.by_user = false}).curves.size(), 12u);
  mesh.labels.clear();
  EXPECT_EQ(find_sharp_edges(mesh).curves.size(), 12u);
  mesh.lines = {{8, 9}, {10, 9}};  // an open line, which noise would be
  const SharpEdges open = find_sharp_edges(mesh);
  EXPECT_EQ(open.n_curves_by(SharpCurve::Reason::Line), 2u);
  EXPECT_EQ(open.n_patches, 6u);
}

TEST(SharpEdges, AStaircaseOfLabelsIsNoCurveAndACircleIsOne) {
  const auto labelled = [](int n, auto is_inside) {
    TriangleMesh mesh = sphere(n, n / 2);
    for (std::size_t f = 0; f < mesh.F.size(); ++f) mesh.labels.push_back(is_inside(mesh.centroid(f)) ? 2 : 1);
    return mesh;
  };
  const auto cap = [](const Vec3& x) { return x.z() > .01; };
  const auto tilted = [](const Vec3& x) { return x.z() + .7 * x.x() > .013; };
  EXPECT_EQ(find_sharp_edges(labelled(200, cap)).curves.size(), 1u);
  EXPECT_TRUE(find_sharp_edges(labelled(200, tilted)).curves.empty());
  // Of a few large triangles it is a choice of the user.
  EXPECT_FALSE(find_sharp_edges(labelled(16, tilted)).curves.empty());
}

}  // namespace
}  // namespace umtet
