// Thickness of bodies and gaps whose thickness is known.

#include "mesh/implicit/thickness.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

using namespace umtet;

namespace {

// A spherical shell r_in < |x| < r_out: wall r_out - r_in, cavity 2 r_in.
struct ActiveLayer {
  double r_in, r_out;
  double value(const Vec3& x) const { return std::max(r_in - x.norm(), x.norm() - r_out); }
  Vec3 gradient(const Vec3& x) const { return (x.norm() > (r_in + r_out) / 2 ? 1.0 : -1.0) * x.normalized(); }
};

std::vector<Vec3> sphere_points(double r) {
  std::vector<Vec3> x;
  for (int i = 0; i < 100; ++i) {
    const double z = (i + 0.5) / 50 - 1, a = i * 2.4;
    x.push_back(r * Vec3(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z));
  }
  return x;
}

}  // namespace

TEST(Thickness, IsTheShorterOfWallAndGap) {
  const ActiveLayer thin{1.0, 1.2}, small_cavity{0.05, 1.0};
  for (const double t : thickness(ImplicitFunctionRef(thin), sphere_points(1.21), 0.03, 1)) EXPECT_NEAR(t, 0.2, 1e-9);
  for (const double t : thickness(ImplicitFunctionRef(small_cavity), sphere_points(0.05), 0.02, 1))
    EXPECT_NEAR(t, 0.1, 1e-9);
}

TEST(Thickness, WhatIsThinnerThanTheFirstStepIsFoundBelowIt) {
  const ActiveLayer leaf{1.0, 1.004}, slit{0.002, 1.0};
  for (const double t : thickness(ImplicitFunctionRef(leaf), sphere_points(1.004), 0.1, 1)) EXPECT_NEAR(t, 0.004, 1e-9);
  for (const double t : thickness(ImplicitFunctionRef(slit), sphere_points(0.002), 0.1, .8))
    EXPECT_NEAR(t, 0.004, 1e-9);
}

TEST(Thickness, StepsAreLongFarFromZeroWhereTheSlopeIsKnown) {
  struct Counted {
    ActiveLayer shell;
    mutable std::atomic<int> n = 0;
    double value(const Vec3& x) const { return ++n, shell.value(x); }
    Vec3 gradient(const Vec3& x) const { return shell.gradient(x); }
  };
  const Counted psi{{1.0, 1.5}};
  for (const double t : thickness(ImplicitFunctionRef(psi), sphere_points(1.5), 0.01, 1)) EXPECT_NEAR(t, 0.5, 1e-9);
  const int n_short = psi.n.exchange(0);
  for (const double t : thickness(ImplicitFunctionRef(psi), sphere_points(1.5), 0.01, 1, {}, 2))
    EXPECT_NEAR(t, 0.5, 1e-9);
  EXPECT_LT(psi.n, n_short / 4);
}

TEST(Thickness, WhatIsThickIsTheLimit) {
  const ActiveLayer shell{1.0, 2.0};
  for (const double t : thickness(ImplicitFunctionRef(shell), sphere_points(2.0), 0.05, 0.5)) EXPECT_EQ(t, 0.5);
}

TEST(Thickness, PointsThatReachNoBoundaryAreTheLimit) {
  const ActiveLayer shell{1.0, 1.1};
  for (const double t : thickness(ImplicitFunctionRef(shell), sphere_points(5.0), 0.05, 0.5)) EXPECT_EQ(t, 0.5);
}
