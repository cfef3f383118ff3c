// Level sets fitted to grids of other programs.

#include "reconstruct/level_set/grid_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
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

Grid mask_of(int n) {
  Grid mask = grid_of(n, [](const Vec3& x) { return ball(x) < 0 ? 3. : 0.; });
  mask.is_whole = true;
  return mask;
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

TEST(GridFit, ASegmentationComesOutSmooth) {
  const int n = 48;
  const double step = 2.6 / (n - 1);
  const MaskFit fit = fit_mask(mask_of(n), std::nullopt, 1);
  EXPECT_NEAR(static_cast<double>(fit.report.n_inside) * step * step * step, 4 * std::numbers::pi / 3, .05);
  EXPECT_LT(fit.report.n_changed, fit.report.n_inside / 50);
  EXPECT_LT(fit.report.farthest_changed, .5 * step);
  double worst = 0, worst_raw = 0;
  const MaskFit raw = fit_mask(mask_of(n), std::nullopt, 0);
  EXPECT_EQ(raw.report.n_changed, 0U);
  for (const Vec3& x : directions(500)) {
    Vec3 g;
    EXPECT_LT(std::abs(fit.psi.evaluate(x, &g, nullptr)), .5 * step);
    worst = std::max(worst, (g.normalized() - x).norm());
    raw.psi.evaluate(x, &g, nullptr);
    worst_raw = std::max(worst_raw, (g.normalized() - x).norm());
  }
  EXPECT_LT(worst, .2);  // radians
  EXPECT_GT(worst_raw, 2 * worst);
}

TEST(GridFit, APartIsChosenByItsNumber) {
  Grid mask = mask_of(24);
  for (std::size_t i = 0; i < mask.size() / 2; ++i) mask.values[i] *= 2;  // below z = 0: part 6
  const MaskFit lower = fit_mask(mask, 6, .7), whole = fit_mask(mask, std::nullopt, .7);
  EXPECT_GT(lower.psi.value({0, 0, .3}), 0);
  EXPECT_LT(lower.psi.value({0, 0, -.3}), 0);
  EXPECT_LT(whole.psi.value({0, 0, .3}), 0);
  EXPECT_THROW(fit_mask(mask, 5, .7), std::invalid_argument);
}

TEST(GridFit, APartThatTouchesTheWallOfTheImageEndsThere) {
  Grid mask = grid_of(12, [](const Vec3& x) { return x.x() > 0 ? 1. : 0.; });
  const MaskFit fit = fit_mask(mask, std::nullopt, .7);
  EXPECT_LT(fit.psi.value({1, 0, 0}), 0);
  EXPECT_GT(fit.psi.value({1.9, 0, 0}), 0);
  EXPECT_GT(fit.psi.box().max().x(), 2);
}

TEST(Grid, SegmentationsAreToldFromFields) {
  Grid grid = mask_of(8);
  EXPECT_TRUE(is_segmentation(grid));
  grid.is_whole = false;
  EXPECT_FALSE(is_segmentation(grid));
  grid.is_whole = true;
  grid.values[5] = -1;
  EXPECT_FALSE(is_segmentation(grid));
  for (std::size_t i = 0; i < grid.size(); ++i) grid.values[i] = static_cast<double>(i);
  EXPECT_FALSE(is_segmentation(grid));
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
