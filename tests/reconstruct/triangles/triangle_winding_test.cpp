#include "reconstruct/triangles/triangle_winding.h"

#include <gtest/gtest.h>

#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

TEST(TriangleWinding, ATriangleSeenFromAfarHasItsProjectedAreaAsSolidAngle) {
  const Vec3 x(3, 4, 1000), a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  // Outward is +z, so x is outside.
  EXPECT_NEAR(solid_angle_share(x, a, b, c), -.5 / 1e6 / (4 * std::numbers::pi), 1e-10);
  EXPECT_NEAR(solid_angle_share(-x, a, b, c), .5 / 1e6 / (4 * std::numbers::pi), 1e-10);
  EXPECT_NEAR(solid_angle_share(Vec3(.2, .2, -1e-9), a, b, c), .5, 1e-7);
}

TEST(TriangleWinding, IsOneInsideZeroOutsideAndTwoInAnOverlap) {
  const TriangleMesh two = test::together(test::torus(), test::moved(test::torus(), {.3, 0, 0}));
  const TriangleWinding w(two);
  EXPECT_NEAR(w({0, 1, 0}), 2, .06);  // within both tubes
  EXPECT_NEAR(w({-1.2, 0, 0}), 1, .06);
  EXPECT_NEAR(w({0, 0, 0}), 0, .06);
  EXPECT_NEAR(w({0, 0, 5}), 0, .06);
  const TriangleWinding cube(test::cube());
  for (const double t : {1e-9, .1, .5, 1 - 1e-9}) EXPECT_NEAR(cube({t, .3, .4}), 1, 1e-6) << t;
  for (const double t : {-1e-9, -3., 1 + 1e-9}) EXPECT_NEAR(cube({t, .3, .4}), 0, 1e-6) << t;
}

TEST(TriangleWinding, TheTreeIsOffTheSumByLittle) {
  const TriangleMesh mesh = test::some_removed(test::torus(), .2);
  const TriangleWinding w(mesh);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  double worst = 0, mean = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x(place(random), place(random), place(random) / 2);
    double sum = 0;
    for (std::size_t f = 0; f < mesh.F.size(); ++f)
      sum += solid_angle_share(x, mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2));
    worst = std::max(worst, std::abs(w(x) - sum));
    mean += std::abs(w(x) - sum) / 1000;
  }
  EXPECT_LT(worst, .06);
  EXPECT_LT(mean, .006);
}

TEST(TriangleWinding, NoTrianglesAreRefused) { EXPECT_THROW(TriangleWinding(TriangleMesh{}), std::invalid_argument); }

}  // namespace
}  // namespace umtet
