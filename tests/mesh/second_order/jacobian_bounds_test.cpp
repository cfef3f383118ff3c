#include "mesh/second_order/jacobian_bounds.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace umtet {
namespace {

using Barycentric = std::array<double, 4>;

const std::array<Vec3, 4> kRegular = {{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}};

/// A regular tet with every mid-side displaced at random by up to `reach`.
QuadraticNodes bent(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> offset(-reach, reach);
  QuadraticNodes x;
  std::copy(kRegular.begin(), kRegular.end(), x.begin());
  for (int k = 0; k < 6; ++k) {
    x[4 + k] = (x[kMidSideEdge[k][0]] + x[kMidSideEdge[k][1]]) / 2;
    x[4 + k] += Vec3(offset(random), offset(random), offset(random));
  }
  return x;
}

/// det dx/dl from the shape functions of quadratic_tet_mesh.h.
double determinant(const QuadraticNodes& x, const Barycentric& l) {
  std::array<Vec3, 4> d;  // dx / dl_j, as if the four were independent
  for (int j = 0; j < 4; ++j) d[j] = (4 * l[j] - 1) * x[j];
  for (int k = 0; k < 6; ++k) {
    const auto [p, q] = kMidSideEdge[k];
    d[p] += 4 * l[q] * x[4 + k];
    d[q] += 4 * l[p] * x[4 + k];
  }
  return (d[1] - d[0]).cross(d[2] - d[0]).dot(d[3] - d[0]);
}

/// f at the points of a grid of n steps in the tet.
template <class F>
void on_grid(int n, const F& f) {
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      for (int k = 0; i + j + k <= n; ++k) {
        f(Barycentric{double(i) / n, double(j) / n, double(k) / n, double(n - i - j - k) / n});
      }
    }
  }
}

double least_on_grid(const QuadraticNodes& x, int n) {
  double least = std::numeric_limits<double>::infinity();
  on_grid(n, [&](const Barycentric& l) { least = std::min(least, determinant(x, l)); });
  return least;
}

TEST(JacobianBounds, StraightTetsHaveOneDeterminant) {
  std::mt19937 random(1);
  const QuadraticNodes x = bent(random, 0);
  for (const double c : jacobian_coefficients(x).c) EXPECT_NEAR(c, 16, 1e-13);
  const JacobianBounds bounds = jacobian_bounds(x);
  EXPECT_NEAR(bounds.scaled_lower(), 1, 1e-10);
  EXPECT_NEAR(bounds.mean, 16, 1e-13);
}

TEST(JacobianBounds, CoefficientsAreThoseOfTheDeterminant) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const QuadraticNodes x = bent(random, .5);
    const JacobianCoefficients coefficients = jacobian_coefficients(x);
    on_grid(4, [&](const Barycentric& l) {
      double sum = 0;
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          for (int k = 0; k < 4; ++k) sum += l[i] * l[j] * l[k] * coefficients.c[kCubicIndex[i][j][k]];
        }
      }
      ASSERT_NEAR(sum, determinant(x, l), 1e-12);
    });
  }
}

TEST(JacobianBounds, EncloseTheLeastDeterminant) {
  std::mt19937 random(3);
  int n_positive = 0, n_by_parts = 0, n_hidden = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const QuadraticNodes x = bent(random, .6);
    const JacobianBounds bounds = jacobian_bounds(x);
    const double sampled = least_on_grid(x, 12);
    ASSERT_LE(bounds.lower, sampled);
    ASSERT_LE(bounds.lower, bounds.upper);
    ASSERT_FALSE(bounds.positive() && sampled <= 0);
    ASSERT_TRUE(bounds.positive() || sampled <= .05 * bounds.mean);
    if (bounds.positive()) {
      EXPECT_GE(bounds.lower, .98 * bounds.upper - 1e-10);
      EXPECT_LE(bounds.upper, least_on_grid(x, 1) + 1e-10);
    }
    const auto& c = jacobian_coefficients(x).c;
    n_positive += bounds.positive();
    n_by_parts += bounds.positive() && *std::min_element(c.begin(), c.end()) <= 0;
    n_hidden += !bounds.positive() && least_on_grid(x, 1) > 0;
  }
  EXPECT_GT(n_positive, 50);
  EXPECT_GT(n_by_parts, 10);  // tets that only smaller parts decide
  EXPECT_GT(n_hidden, 10);    // tets that are right at their corners
}

TEST(JacobianBounds, ADeterminantThatTouchesZeroIsNotPositive) {
  // The mid-side of edge 01 at a quarter of it: det vanishes at that corner, linearly along the edge.
  std::mt19937 random(4);
  QuadraticNodes x = bent(random, 0);
  x[4] = .75 * x[0] + .25 * x[1];
  const JacobianBounds bounds = jacobian_bounds(x);
  EXPECT_FALSE(bounds.positive());
  EXPECT_NEAR(bounds.upper, 0, 1e-11);
  x[4] = .749 * x[0] + .251 * x[1];
  EXPECT_TRUE(jacobian_bounds(x).positive());
}

TEST(JacobianBounds, RoundingIsBounded) {
  std::mt19937 random(5);
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    QuadraticNodes x = bent(random, .3);
    for (Vec3& p : x)
      p = (1e-3 * p).array() + 1000.;  // what these nodes are, rounded, is the question that is answered
    const JacobianCoefficients coefficients = jacobian_coefficients(x);
    EXPECT_LT(coefficients.rounding, 1e-11 * mean_jacobian(coefficients));
    const auto at_corner_0 = [&] {
      using Long = Eigen::Matrix<long double, 3, 1>;
      std::array<Long, 4> y;
      const auto node = [&](int n) { return Long(x[n].cast<long double>() - x[0].cast<long double>()); };
      for (int j = 1; j < 4; ++j) {
        const int k = j == 1 ? 4 : j == 2 ? 6 : 7;
        y[j] = 4 * node(k) - node(j);  // dx/dl_j - dx/dl_0 at l_0 = 1
      }
      return y[1].cross(y[2]).dot(y[3]);
    }();
    const auto error = static_cast<double>(std::abs(coefficients.c[kCubicIndex[0][0][0]] - at_corner_0));
    EXPECT_LE(error, coefficients.rounding);
    worst = std::max(worst, error);
  }
  EXPECT_GT(worst, 0);
}

TEST(JacobianBounds, NothingIsProvedOfNodesThatAreNotFinite) {
  std::mt19937 random(6);
  for (const double broken : {std::nan(""), std::numeric_limits<double>::infinity(), 1e200}) {
    QuadraticNodes x = bent(random, .1);
    x[7].y() = broken;
    EXPECT_FALSE(jacobian_bounds(x).positive());
  }
}

}  // namespace
}  // namespace umtet
