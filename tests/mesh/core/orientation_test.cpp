#include "mesh/core/orientation.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>

namespace umtet {
namespace {

using Rational = boost::multiprecision::cpp_rational;

/// The determinant in rationals, expanded along the other axis than the code under test.
int rational_sign(const Vec3 (&p)[4]) {
  Rational r[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) r[i][k] = Rational(p[i + 1][k]) - Rational(p[0][k]);
  }
  const Rational det = r[0][0] * r[1][1] * r[2][2] + r[0][1] * r[1][2] * r[2][0] + r[0][2] * r[1][0] * r[2][1] -
                       r[0][2] * r[1][1] * r[2][0] - r[0][1] * r[1][0] * r[2][2] - r[0][0] * r[1][2] * r[2][1];
  return det.sign();
}

TEST(Orientation, IsPositiveForTheTetOfTheAxes) {
  EXPECT_EQ(orientation_sign({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orientation_sign({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}), -1);
}

TEST(Orientation, AgreesWithRationalsOnNearlyFlatTets) {
  // Coplanar quadruples of a lattice far from the origin, each coordinate moved by at most one unit in the last place:
  // the determinant is of the order of its own rounding error or exactly zero.
  std::mt19937 random(7);
  std::uniform_int_distribution<int> lattice(-4, 4), ulp(-1, 1);
  int count[3] = {0, 0, 0};
  for (int trial = 0; trial < 4000; ++trial) {
    const Vec3 origin(lattice(random) + 1.0 / 3, 100.0 / 7, -1e3 / 9);
    const Vec3 u(lattice(random), lattice(random), lattice(random)),
        v(lattice(random), lattice(random), lattice(random));
    Vec3 p[4] = {origin, origin + 0.1 * u, origin + 0.1 * v, origin + 0.1 * (u + v)};
    for (Vec3& x : p) {
      for (int k = 0; k < 3; ++k) {
        if (const int step = ulp(random)) x[k] = std::nextafter(x[k], step * std::numeric_limits<double>::infinity());
      }
    }
    const int expected = rational_sign(p);
    ++count[expected + 1];
    ASSERT_EQ(orientation_sign(p[0], p[1], p[2], p[3]), expected) << "trial " << trial;
    ASSERT_EQ(orientation_sign(p[1], p[0], p[2], p[3]), -expected);
  }
  for (const int n : count) EXPECT_GT(n, 20) << "the trial should contain positive, flat and inverted tets";
}

TEST(Orientation, ExactlyFlatTetsAreFlat) {
  std::mt19937 random(8);
  std::uniform_int_distribution<long> integer(-(1L << 24), 1L << 24);
  for (int trial = 0; trial < 1000; ++trial) {
    // All sums are integers below 2^53, so the points lie in one plane without rounding.
    const auto draw = [&] { return Vec3(double(integer(random)), double(integer(random)), double(integer(random))); };
    const Vec3 a = draw(), u = draw(), v = draw();
    ASSERT_EQ(orientation_sign(a, a + u, a + v, a + 3 * u - 2 * v), 0);
  }
}

TEST(Orientation, SurvivesOverflowAndUnderflow) {
  for (const double s : {1e-320, 1e-160, 1e150, 1e300}) {
    EXPECT_EQ(orientation_sign({0, 0, 0}, {s, 0, 0}, {0, s, 0}, {0, 0, s}), 1) << s;
    EXPECT_EQ(orientation_sign({0, 0, 0}, {s, 0, 0}, {0, s, 0}, {s, s, -s}), -1) << s;
    EXPECT_EQ(orientation_sign({0, 0, 0}, {s, 0, 0}, {0, s, 0}, {s, s, 0}), 0) << s;
  }
  EXPECT_EQ(orientation_sign({0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 5e-324}), 1);
}

TEST(Orientation, ATetWithoutFiniteCoordinatesHasNoSign) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(orientation_sign({nan, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0);
  EXPECT_EQ(orientation_sign({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, inf}), 0);
}

}  // namespace
}  // namespace umtet
