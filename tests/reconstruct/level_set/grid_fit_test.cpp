// Level sets fitted to grids of other programs.

#include "reconstruct/level_set/grid_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>

using namespace umtet;

namespace {

/// f at n^3 nodes of [-1.3, 1.3]^3.
template <class F>
Grid grid_of(int n, const F& f) {
  Grid grid;
  grid.n = Eigen::Vector3i::Constant(n);
  grid.axes *= 2.6 / (n - 1);
  grid.origin = Vec3::Constant(-1.3);
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) grid.values.push_back(f(Vec3(grid.origin + grid.axes * Vec3(i, j, k))));
    }
  }
  return grid;
}

double ball(const Vec3& x) { return x.norm() - 1; }

std::vector<Vec3> directions(int n) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vec3> all;
  for (int i = 0; i < n; ++i) all.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
  return all;
}

/// The greatest |psi| on the unit sphere.
double error_of(const GridLevelSet& psi) {
  double most = 0;
  for (const Vec3& x : directions(2000)) most = std::max(most, std::abs(psi.value(x)));
  return most;
}

}  // namespace

TEST(GridFit, NodesHaveTheValuesOfTheGrid) {
  const Grid grid = grid_of(12, ball);
  const GridLevelSet psi = interpolate(grid);
  for (const int node : {0, 5, 700, 12 * 12 * 12 - 1}) {
    const Vec3 at(node % 12, node / 12 % 12, node / 144);
    EXPECT_NEAR(psi.value(grid.origin + grid.axes * at), grid.values[static_cast<std::size_t>(node)], 1e-12);
  }
}

TEST(GridFit, AxesMayBeStretchedTurnedAndSheared) {
  const auto linear = [](const Vec3& x) { return x.dot(Vec3(.3, -1.2, .7)) + .4; };
  Grid grid = grid_of(9, [](const Vec3&) { return 0; });
  grid.axes = Eigen::AngleAxisd(.7, Vec3(1, 2, 3).normalized()) * Vec3(.1, .2, .4).asDiagonal();
  grid.axes(0, 1) += .05;
  for (int k = 0, at = 0; k < 9; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 9; ++i) grid.values[at++] = linear(grid.origin + grid.axes * Vec3(i, j, k));
    }
  }
  const GridLevelSet psi = interpolate(grid);
  for (const Vec3& u : directions(20)) {
    const Vec3 x = grid.origin + grid.axes * (Vec3::Constant(4) + 3 * u);
    Vec3 g;
    Mat3 H;
    EXPECT_NEAR(psi.evaluate(x, &g, &H), linear(x), 1e-10);
    EXPECT_LT((g - Vec3(.3, -1.2, .7)).norm(), 1e-8);
    EXPECT_LT(H.norm(), 1e-5);
  }
  EXPECT_TRUE(psi.box().contains(grid.origin + grid.axes * Vec3(8, 8, 8)));
}

TEST(GridFit, DerivativesPassFiniteDifferences) {
  Grid grid = grid_of(16, ball);
  grid.axes = Eigen::AngleAxisd(.4, Vec3::UnitY()) * Vec3(1, .8, 1.3).asDiagonal() * grid.axes;
  const GridLevelSet psi = interpolate(std::move(grid));
  const double e = 1e-5;
  for (const Vec3& u : directions(20)) {
    const Vec3 x = psi.box().center() + .6 * u;
    Vec3 g;
    Mat3 H;
    psi.evaluate(x, &g, &H);
    for (int d = 0; d < 3; ++d) {
      Vec3 up, down;
      const double above = psi.evaluate(x + e * Vec3::Unit(d), &up, nullptr);
      const double below = psi.evaluate(x - e * Vec3::Unit(d), &down, nullptr);
      EXPECT_NEAR(g[d], (above - below) / (2 * e), 1e-8);
      EXPECT_LT((H.col(d) - (up - down) / (2 * e)).norm(), 1e-4);
    }
  }
}

TEST(GridFit, TheErrorOfASphereFallsWithTheGrid) {
  const double e_16 = error_of(interpolate(grid_of(16, ball))), e_32 = error_of(interpolate(grid_of(32, ball))),
               e_64 = error_of(interpolate(grid_of(64, ball)));
  EXPECT_LT(e_32, e_16 / 4);
  EXPECT_LT(e_64, e_32 / 3);
  EXPECT_LT(e_64, 3e-4 * 2.6 / 63);  // of a step
}

TEST(Grid, EveryFaultIsNamed) {
  Grid grid = grid_of(7, ball);
  EXPECT_TRUE(problems(grid).empty());
  grid.axes.col(1) = 2 * grid.axes.col(0);
  grid.values[8] = std::nan("");
  const std::vector<std::string> wrong = problems(grid);
  ASSERT_EQ(wrong.size(), 2U);
  EXPECT_NE(wrong[1].find("(1, 1, 0)"), std::string::npos) << wrong[1];
  grid.n[2] = 5;
  EXPECT_EQ(problems(grid).size(), 1U);
}
