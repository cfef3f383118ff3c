// What a grid of values is, and what is inside of it.

#include "reconstruct/level_set/image_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reconstruct/level_set/grid_fit.h"
#include "tests/support/label_volumes.h"

using namespace umtet;

namespace {

Grid volume(const std::function<double(const Vec3&)>& f) {
  return label_volume_of(Eigen::Vector3i::Constant(24), Vec3::Ones(), f);
}

/// Bright in a ball, dark around it, as a scanner sees it: whole numbers.
double ct(const Vec3& x) { return std::round(1000 / (1 + std::exp(2 * (x.norm() - 7)))); }

}  // namespace

TEST(GridKind, WholeNumbersOfPartsAreASegmentationHoweverTheyAreStored) {
  const auto parts = [](const Vec3& x) { return std::floor((x.x() + 12) / 5) + 5 * std::floor((x.y() + 12) / 5); };
  for (Grid grid : {volume([](const Vec3& x) { return is_in_ball(x, 8); }),
                    volume([](const Vec3& x) { return 255 * is_in_ball(x, 8); }), volume(parts),
                    volume([&](const Vec3& x) { return 1000 * parts(x); })}) {
    EXPECT_EQ(kind_of(grid), GridKind::Segmentation);
    grid.is_whole = false;
    EXPECT_EQ(kind_of(grid), GridKind::Segmentation);
  }
}

TEST(GridKind, ThousandsOfPartsAreASegmentation) {
  const Grid grid = volume([](const Vec3& x) {
    const Eigen::Vector3i cell = ((x.array() + 12) / 2).floor().cast<int>();
    return static_cast<double>(1 + (cell[0] * 7919 + cell[1] * 104729 + cell[2] * 1299709) % 9973);
  });
  EXPECT_EQ(kind_of(grid), GridKind::Segmentation);
}

TEST(GridKind, GreyValuesAreAnImage) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 20);
  EXPECT_EQ(kind_of(volume(ct)), GridKind::Image);
  EXPECT_EQ(kind_of(volume([](const Vec3& x) { return .01 * ct(x) + .005; })), GridKind::Image);
  EXPECT_EQ(kind_of(volume([](const Vec3& x) { return ct(x) - 900; })), GridKind::Image);
  EXPECT_EQ(kind_of(volume([&](const Vec3& x) { return std::max(0., std::round(ct(x) + noise(random))); })),
            GridKind::Image);
  // Hounsfield units that are no whole numbers: what is below 0 is the air, up to the wall.
  EXPECT_EQ(kind_of(volume([](const Vec3& x) { return 1.7 * ct(x) - 900.3; })), GridKind::Image);
}

TEST(GridKind, WhatIsNegativeInsideIsALevelSet) {
  EXPECT_EQ(kind_of(volume([](const Vec3& x) { return x.norm() - 8; })), GridKind::LevelSet);
}

TEST(ImageLevel, LiesBetweenDarkAndBright) {
  const double level = suggested_level(volume(ct));
  EXPECT_GT(level, 200);
  EXPECT_LT(level, 800);
  EXPECT_EQ(level, std::round(level / 10) * 10) << "few digits";
  const double of_fractions = suggested_level(volume([](const Vec3& x) { return 1e-3 * ct(x); }));
  EXPECT_NEAR(of_fractions, .5, .3);
}

TEST(ImageLevel, BetweenIsNegativeBetween) {
  Grid grid = volume(ct);
  const std::vector<double> before = grid.values;
  take_between(grid, 200, 500);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(grid.values[i]<0, before[i]> 200 && before[i] < 500) << before[i];
}

TEST(ImageLevel, ABodyThatReachesTheWallEndsThere) {
  Grid grid = volume([](const Vec3& x) { return 30 * x.z(); });
  ASSERT_TRUE(close_at_wall(grid, 6));
  EXPECT_EQ(grid.n, Eigen::Vector3i::Constant(36));
  EXPECT_EQ(wall_share(grid, [](double v) { return v < 0; }), 0);
  const GridLevelSet psi = interpolate(std::move(grid));
  EXPECT_LT(psi.value({0, 0, -11}), 0);
  EXPECT_GT(psi.value({0, 0, -13}), 0);
  EXPECT_LT(psi.value({11, 0, -5}), 0);
  EXPECT_GT(psi.value({13, 0, -5}), 0);
  EXPECT_GT(psi.value({0, 0, 1}), 0);
}

TEST(ImageLevel, ABodyInTheMiddleStaysAsItIs) {
  Grid grid = volume([](const Vec3& x) { return x.norm() - 8; });
  const std::vector<double> before = grid.values;
  EXPECT_FALSE(close_at_wall(grid, 6));
  EXPECT_EQ(grid.values, before);
}
