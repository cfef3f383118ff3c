#include "reconstruct/triangles/patch_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

/// A part of a paraboloid z = (x^2 + y^2) / 4 over the unit square, facing up.
TriangleMesh bowl(int n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      mesh.V.emplace_back(x, y, (x * x + y * y) / 4);
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      mesh.F.push_back({a, a + 1, a + n + 2});
      mesh.F.push_back({a, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

TEST(PatchSurface, TheTrianglesAreItsZeroSet) {
  const TriangleMesh mesh = bowl(8);
  const PatchSurface f(mesh);
  for (std::size_t k = 0; k < mesh.F.size(); ++k) {
    const Vec3 x = mesh.centroid(k), n = mesh.area_vector(k).normalized();
    EXPECT_NEAR(f.evaluate(x, nullptr), 0, 1e-14);
    Vec3 g;
    EXPECT_NEAR(f.evaluate(x + .01 * n, &g), .01, 1e-12);
    EXPECT_LT((g - n).norm(), 1e-9);
    EXPECT_NEAR(f.evaluate(x - .01 * n, nullptr), -.01, 1e-12);
  }
}

TEST(PatchSurface, ItGoesOnBeyondItsBorder) {
  const PatchSurface f(bowl(8));
  // At the border x = 0 the normal is vertical but for the last facet's slope.
  Vec3 g;
  const double value = f.evaluate(Vec3(-.3, .5, .2), &g);
  EXPECT_GT(value, .1);
  EXPECT_LT(value, .2);
  EXPECT_GT(g.z(), .95);
  EXPECT_LT(f.evaluate(Vec3(-.3, .5, 0), nullptr), 0);
}

TEST(PatchSurface, NewtonsMethodArrives) {
  const PatchSurface f(bowl(8));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(.1, .9);
  for (int k = 0; k < 100; ++k) {
    Vec3 x(at(random), at(random), at(random));
    for (int step = 0; step < 6; ++step) {
      Vec3 g;
      const double value = f.evaluate(x, &g);
      x -= value * g;
    }
    EXPECT_NEAR(f.evaluate(x, nullptr), 0, 1e-12);
  }
}

TEST(PatchSurface, ACubeHasSixPatchesOfTwoTriangles) {
  const TriangleMesh cube = test::cube();
  const auto patches = split_patches(cube, find_sharp_edges(cube));
  ASSERT_EQ(patches.size(), 6u);
  for (const TriangleMesh& patch : patches) {
    EXPECT_EQ(patch.F.size(), 2u);
    EXPECT_EQ(patch.V.size(), 4u);
  }
}

}  // namespace
}  // namespace umtet
