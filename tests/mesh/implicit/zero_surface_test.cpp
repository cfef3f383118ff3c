#include "mesh/implicit/zero_surface.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <map>

#include "tests/support/values.h"

namespace umtet {
namespace {

using Box3 = Eigen::AlignedBox3d;

struct Ball {
  Vec3 centre;
  double radius;
  double value(const Vec3& x) const { return (x - centre).norm() - radius; }
  Vec3 gradient(const Vec3& x) const { return (x - centre).normalized(); }
};

struct Ring {
  double value(const Vec3& x) const { return std::hypot(std::hypot(x.x(), x.y()) - 1, x.z()) - .4; }
  Vec3 gradient(const Vec3& x) const {
    const double r = std::hypot(x.x(), x.y()), d = std::hypot(r - 1, x.z());
    return {x.x() / r * (r - 1) / d, x.y() / r * (r - 1) / d, x.z() / d};
  }
};

Box3 cube(double half) { return {Vec3::Constant(-half), Vec3::Constant(half)}; }

/// Returns the Euler characteristic; expects every edge in two faces that run along it in opposite directions.
long characteristic_of_closed(const ZeroSurface& s) {
  std::map<std::pair<int, int>, int> n_halves;
  for (const auto& f : s.F)
    for (int k = 0; k < 3; ++k) ++n_halves[{f[k], f[(k + 1) % 3]}];
  for (const auto& [edge, n] : n_halves) {
    EXPECT_EQ(n, 1);
    EXPECT_TRUE(n_halves.contains({edge.second, edge.first}));
  }
  return static_cast<long>(s.V.size()) - static_cast<long>(n_halves.size() / 2) + static_cast<long>(s.F.size());
}

double volume(const ZeroSurface& s) {
  double six = 0;
  for (const auto& f : s.F) six += s.V[f[0]].dot(s.V[f[1]].cross(s.V[f[2]]));
  return six / 6;
}

TEST(ZeroSurface, IsClosedFacesOutAndLiesOnPsi) {
  const ZeroSurface ball = zero_surface(Ball{{.1, 0, 0}, 1}, cube(1.5), .1);
  EXPECT_EQ(characteristic_of_closed(ball), 2);
  EXPECT_NEAR(volume(ball), 4 * M_PI / 3, .02);
  const ZeroSurface ring = zero_surface(Ring(), cube(1.7), .08);
  EXPECT_EQ(characteristic_of_closed(ring), 0);
  EXPECT_NEAR(volume(ring), 2 * M_PI * M_PI * .16, .03);
  for (const Vec3& x : ring.V) EXPECT_NEAR(Ring().value(x), 0, 1e-4);
}

TEST(ZeroSurface, StartsAtPointsWhereTheCoarseGridSeesNothing) {
  // A ball smaller than a cube of the coarse grid, around none of its nodes.
  const Ball small{{.21, .17, .19}, .12};
  const Box3 box = cube(2);
  EXPECT_TRUE(zero_surface(small, box, .1).F.empty());
  EXPECT_EQ(characteristic_of_closed(zero_surface(small, box, .1, {small.centre + Vec3(.12, 0, 0)})), 2);
  // Points elsewhere, far away and not finite start nothing.
  EXPECT_TRUE(zero_surface(small, box, .1, {{1, 1, 1}, {1e30, 0, 0}, {NAN, 0, 0}}).F.empty());
}

TEST(ZeroSurface, TakesWhatIsNotFiniteAsOutside) {
  const testing::Values half{
      [](const Vec3& x) { return x.z() > .33 ? std::numeric_limits<double>::quiet_NaN() : x.norm() - 1; }};
  const ZeroSurface s = zero_surface(half, cube(1.5), .1);
  EXPECT_EQ(characteristic_of_closed(s), 2);
  for (const Vec3& x : s.V) EXPECT_TRUE(x.allFinite());
}

TEST(ZeroSurface, DoesNotDependOnTheNumberOfThreads) {
  const ZeroSurface many = zero_surface(Ring(), cube(1.7), .05);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const ZeroSurface one = zero_surface(Ring(), cube(1.7), .05);
  EXPECT_EQ(many.V, one.V);
  EXPECT_EQ(many.F, one.F);
}

TEST(ZeroSurface, RefusesWhatIsNoGrid) {
  EXPECT_THROW(zero_surface(Ring(), cube(1), 0), std::invalid_argument);
  EXPECT_THROW(zero_surface(Ring(), Box3(), .1), std::invalid_argument);
  EXPECT_THROW(zero_surface(Ring(), cube(1), 1e-9), std::length_error);
}

}  // namespace
}  // namespace umtet
