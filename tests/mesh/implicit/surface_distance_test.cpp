#include "mesh/implicit/surface_distance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

TEST(PointTriangleDistance, KnowsFaceEdgeAndCorner) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_DOUBLE_EQ(point_triangle_distance({0.2, 0.2, 3}, a, b, c), 3);
  EXPECT_DOUBLE_EQ(point_triangle_distance({0.5, -4, 3}, a, b, c), 5);
  EXPECT_DOUBLE_EQ(point_triangle_distance({-3, -4, 0}, a, b, c), 5);
  EXPECT_DOUBLE_EQ(point_triangle_distance({1, 1, 0}, a, b, c), std::sqrt(0.5));
  EXPECT_EQ(point_triangle_distance({0.2, 0.2, 0}, a, b, c), 0);
  EXPECT_DOUBLE_EQ(point_triangle_distance({0.5, 2, 0}, a, b, 0.5 * (a + b)), 2) << "a segment";
  EXPECT_DOUBLE_EQ(point_triangle_distance({0, 0, 2}, a, a, a), 2) << "a point";
}

TEST(SurfaceDistance, EqualsTheLeastOverAllTriangles) {
  // Large and tiny, fat and needle-like triangles: the nearest centroid is often not the nearest triangle.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto draw = [&] { return Vec3(u(random), u(random), u(random)); };
  std::vector<Vec3> V;
  std::vector<Triangle> faces;
  for (int i = 0; i < 400; ++i) {
    const double size = std::pow(10.0, -1 + 1.2 * u(random));
    const int n = static_cast<int>(V.size());
    V.push_back(draw());
    V.push_back(V[n] + size * draw());
    V.push_back(V[n] + size * (i % 3 ? draw() : Vec3(0.01 * draw())));
    faces.push_back({n, n + 1, n + 2});
  }
  std::vector<Vec3> x;
  for (int i = 0; i < 2000; ++i) x.push_back(1.5 * draw());
  for (int i = 0; i < 1000; ++i) x.push_back(x.back() + .01 * draw());  // one bounds the next
  const SurfaceDistance surface(V, faces);
  const std::vector<double> d = surface.distances(x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& f : faces) least = std::min(least, point_triangle_distance(x[i], V[f[0]], V[f[1]], V[f[2]]));
    ASSERT_EQ(d[i], least) << i;
  }
}

TEST(SurfaceDistance, OfASphereIsRadialAndIndependentOfThreads) {
  std::vector<Triangle> faces;
  const TetMesh sphere = testing::sphere_surface(5, faces);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vec3> x;
  for (int i = 0; i < 5000; ++i) x.push_back(1.3 * Vec3(normal(random), normal(random), normal(random)).normalized());
  const SurfaceDistance surface(sphere.V, faces);
  std::vector<double> d[2];
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    d[threads - 1] = surface.distances(x);
  }
  EXPECT_EQ(d[0], d[1]);
  // No face lies deeper inside the sphere than its plane.
  double least_radius = 1;
  for (const Triangle& f : faces) {
    const Vec3 &a = sphere.V[f[0]], &b = sphere.V[f[1]], &c = sphere.V[f[2]];
    least_radius = std::min(least_radius, (b - a).cross(c - a).normalized().dot(a));
  }
  EXPECT_GT(least_radius, 0.998);
  for (const double value : d[0]) {
    ASSERT_GE(value, 0.3 - 1e-15);
    ASSERT_LE(value, 1.3 - least_radius + 1e-15);
  }
}

TEST(SurfaceDistance, SamplesOnOneHalfLeaveTheOtherUnsupported) {
  std::vector<Triangle> faces;
  const TetMesh sphere = testing::sphere_surface(4, faces);
  std::vector<Vec3> samples;
  for (const Vec3& v : sphere.V) {
    if (v.z() >= 0) samples.push_back(v);
  }
  // A belt of width .15 below the equator is within reach: its share of the sphere is .15 / 2.
  EXPECT_NEAR(unsupported_area_fraction(sphere.V, faces, SampleDistance(samples), 0.15), 0.5 - 0.075, 0.02);
  EXPECT_EQ(unsupported_area_fraction(sphere.V, faces, SampleDistance(sphere.V), 0.15), 0);
  std::vector<Triangle> few;
  const TetMesh coarse =
      testing::sphere_surface(1, few);  // its flat faces are far from any sample, its vertices are not
  EXPECT_EQ(unsupported_area_fraction(coarse.V, few, SampleDistance(sphere.V), 0.05), 0);
  const std::vector<double> d = SampleDistance(samples).distances({{0, 0, -1}, {0, 0, 3}});
  EXPECT_DOUBLE_EQ(d[0], std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(d[1], 2);
  EXPECT_EQ(distances_to_samples(samples, {{0, 0, -1}, {0, 0, 3}}), d);
}

TEST(SurfaceDistance, RefusesWhatHasNoDistance) {
  const std::vector<Vec3> V = {{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}};
  EXPECT_THROW(SurfaceDistance(V, {}), std::invalid_argument);
  EXPECT_THROW(SurfaceDistance(V, {{0, 1, 3}}), std::invalid_argument);
  EXPECT_THROW(SurfaceDistance(V, {{0, 1, 2}}), std::invalid_argument);
  EXPECT_THROW(SampleDistance({}), std::invalid_argument);
  EXPECT_THROW(distances_to_samples({}, V), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
