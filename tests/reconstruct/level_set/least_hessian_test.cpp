// The least Hessian energy under bounds.

#include "reconstruct/level_set/least_hessian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace umtet;

namespace {

constexpr int kN = 20;

std::size_t index(int i, int j, int k) { return static_cast<std::size_t>(i + kN * (j + kN * k)); }

BoundedValues bounded(const std::function<float(int, int, int)>& f, float room) {
  BoundedValues u;
  u.n = Eigen::Vector3i::Constant(kN);
  for (int k = 0; k < kN; ++k) {
    for (int j = 0; j < kN; ++j) {
      for (int i = 0; i < kN; ++i) {
        u.value.push_back(f(i, j, k));
        u.low.push_back(f(i, j, k) - room);
        u.high.push_back(f(i, j, k) + room);
        const bool is_free = std::min({i, j, k}) >= 2 && std::max({i, j, k}) < kN - 2;
        u.is_free.push_back(is_free ? 1 : 0);
      }
    }
  }
  return u;
}

/// Squares of all second differences along the axes.
double bending(const BoundedValues& u) {
  double sum = 0;
  for (int k = 1; k + 1 < kN; ++k) {
    for (int j = 1; j + 1 < kN; ++j) {
      for (int i = 1; i + 1 < kN; ++i) {
        const double v = 2 * u.value[index(i, j, k)];
        sum += std::pow(u.value[index(i - 1, j, k)] + u.value[index(i + 1, j, k)] - v, 2) +
               std::pow(u.value[index(i, j - 1, k)] + u.value[index(i, j + 1, k)] - v, 2) +
               std::pow(u.value[index(i, j, k - 1)] + u.value[index(i, j, k + 1)] - v, 2);
      }
    }
  }
  return sum;
}

float stairs(int i, int j, int k) { return std::round(.3F * i + .2F * j - .4F * k); }

}  // namespace

TEST(LeastHessian, AnAffineFunctionStaysAsItIs) {
  const auto affine = [](int i, int j, int k) { return .3F * i + .2F * j - .4F * k; };
  BoundedValues u = bounded(affine, 1);
  minimise_hessian(u, Vec3(1, 2, .5));
  for (int k = 0; k < kN; ++k)
    for (int j = 0; j < kN; ++j)
      for (int i = 0; i < kN; ++i) EXPECT_NEAR(u.value[index(i, j, k)], affine(i, j, k), 1e-3);
}

TEST(LeastHessian, StairsBecomeARampWithinTheirBounds) {
  BoundedValues u = bounded(stairs, .5F);
  const BoundedValues before = u;
  minimise_hessian(u, Vec3::Ones());
  EXPECT_LT(bending(u), .5 * bending(before));
  for (std::size_t i = 0; i < u.value.size(); ++i) {
    if (!u.is_free[i]) EXPECT_EQ(u.value[i], before.value[i]);
    EXPECT_GE(u.value[i], u.low[i]);
    EXPECT_LE(u.value[i], u.high[i]);
  }
  const int m = kN / 2;
  EXPECT_NEAR(u.value[index(m, m, m)], .3 * m + .2 * m - .4 * m, .2);
}

TEST(LeastHessian, NoRoomNoChange) {
  BoundedValues u = bounded(stairs, 0);
  const BoundedValues before = u;
  minimise_hessian(u, Vec3::Ones());
  EXPECT_EQ(u.value, before.value);
}
