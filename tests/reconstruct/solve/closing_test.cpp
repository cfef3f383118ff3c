// What the fit makes of scans with parts missing: bodies that are cut, whose truth is known.

#include "reconstruct/solve/closing.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"

namespace umtet::test {
namespace {

using How = FittedHole::How;

OrientedPointCloud ball_cloud(int n) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  OrientedPointCloud cloud;
  for (int i = 0; i < n; ++i) {
    const Vec3 x = Vec3(normal(random), normal(random), normal(random)).normalized();
    cloud.points.push_back(x);
    cloud.normals.push_back(x);
  }
  return cloud;
}

/// A tube of radius 1 from z = -2 to 0 under half a ball, open below.
OrientedPointCloud can_cloud(int n) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> height(-2, 1), angle(0, 2 * std::numbers::pi);
  OrientedPointCloud cloud;
  for (int i = 0; i < n; ++i) {
    const double z = height(random), u = angle(random), up = std::max(0., z), r = std::sqrt(1 - up * up);
    cloud.normals.emplace_back(r * std::cos(u), r * std::sin(u), up);
    cloud.points.emplace_back(r * std::cos(u), r * std::sin(u), z);
  }
  return cloud;
}

OrientedPointCloud part_of(const OrientedPointCloud& whole, const std::function<bool(const Vec3&)>& keep) {
  OrientedPointCloud part;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    if (!keep(whole.points[i])) continue;
    part.points.push_back(whole.points[i]);
    part.normals.push_back(whole.normals[i]);
  }
  return part;
}

double volume_inside(const LevelSet& psi) {
  constexpr int kCells = 120;
  const Eigen::AlignedBox3d& box = psi.domain();
  std::size_t inside = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      for (int k = 0; k < kCells; ++k)
        inside += psi.value(box.min() + (Vec3(i + .5, j + .5, k + .5) / kCells).cwiseProduct(box.sizes())) < 0;
  return box.volume() * static_cast<double>(inside) / std::pow(kCells, 3);
}

SsdFit fit(const OrientedPointCloud& cloud, Closing closing = Closing::Auto) {
  SsdParams params;
  params.closing = closing;
  return fit_ssd(cloud, params);
}

TEST(ScanClosing, ABallThatIsCutByAPlaneIsABallAgain) {
  const OrientedPointCloud whole = ball_cloud(12000);
  const double all = 4 * std::numbers::pi / 3;
  for (const Vec3& d : {Vec3(0, 0, -1), Vec3(.4, -.7, .6)}) {
    for (const double share : {.1, .25, .4}) {
      const SsdFit closed = fit(part_of(whole, [&](const Vec3& x) { return x.dot(d.normalized()) < 1 - 2 * share; }));
      EXPECT_GT(closed.report.least_wall_value, 0) << share;
      EXPECT_NEAR(volume_inside(closed.psi), all, .01 * all) << share;
    }
  }
}

TEST(ScanClosing, WhatStoodOnATableEndsAtTheTable) {
  const SsdFit closed = fit(can_cloud(15000));
  ASSERT_EQ(closed.report.holes.size(), 1U);
  const FittedHole& hole = closed.report.holes.front();
  EXPECT_EQ(hole.how, How::Flat);
  EXPECT_LT((hole.hole.normal - Vec3(0, 0, -1)).norm(), .02);
  EXPECT_NEAR(hole.hole.rim_cosine, 0, .05);
  EXPECT_GT(closed.report.least_wall_value, 0);
  // A rim of two cells of the coarsest lattice is rounded; within it the end is within a hundredth of the diameter.
  for (const double r : {0., .3, .6, .8}) {
    for (const double u : {0., 2., 4.}) {
      const Vec3 below(r * std::cos(u), r * std::sin(u), -2.05), above(below[0], below[1], -1.95);
      EXPECT_GT(closed.psi.value(below), 0) << r;
      EXPECT_LT(closed.psi.value(above), 0) << r;
    }
  }
}

TEST(ScanClosing, TheEndsOfATubeBulgeNoFartherThanTheTube) {
  // 40 % of a torus's surface lie below some height. The bottom that closes it is a ring, not a plate over its hole.
  const SsdFit closed = fit(part_of(torus_cloud(20000), [](const Vec3& x) { return x[2] > -.124; }));
  EXPECT_GT(closed.report.least_wall_value, 0);
  for (const double z : {-.5, -.3, 0., .3}) EXPECT_GT(closed.psi.value({0, 0, z}), 0) << z;
  const double all = 2 * std::pow(std::numbers::pi * kTorusr, 2) * kTorusR;
  EXPECT_NEAR(volume_inside(closed.psi), all, .12 * all);
}

TEST(ScanClosing, ClosedCloudsKeepTheirBits) {
  const OrientedPointCloud cloud = torus_cloud(8000);
  const SsdFit with = fit(cloud), without = fit(cloud, Closing::None);
  EXPECT_TRUE(with.report.holes.empty());
  for (const Vec3& x : torus_cloud(200, 5).points) EXPECT_EQ(with.psi.value(1.1 * x), without.psi.value(1.1 * x));
}

TEST(ScanClosing, NoneLeavesPsiToTheWall) {
  const SsdFit open = fit(can_cloud(8000), Closing::None);
  EXPECT_LT(open.report.least_wall_value, 0);
  EXPECT_TRUE(open.report.holes.empty());
}

TEST(ScanClosing, FlatIsFlatWhereSmoothIsRound) {
  const OrientedPointCloud bowl = part_of(ball_cloud(12000), [](const Vec3& x) { return x[2] > -.5; });
  const SsdFit flat = fit(bowl, Closing::Flat), smooth = fit(bowl, Closing::Smooth);
  EXPECT_GT(flat.psi.value({0, 0, -.6}), 0);
  EXPECT_LT(flat.psi.value({0, 0, -.42}), 0);
  EXPECT_LT(smooth.psi.value({0, 0, -.9}), 0);
}

TEST(ScanClosing, ASheetHasNoBody) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> side(-1, 1);
  OrientedPointCloud sheet;
  for (int i = 0; i < 6000; ++i) {
    const double x = side(random), y = side(random);
    sheet.points.emplace_back(x, y, .2 * std::sin(3 * x));
    sheet.normals.push_back(Vec3(-.6 * std::cos(3 * x), 0, 1).normalized());
  }
  EXPECT_LT(fit(sheet).report.least_wall_value, 0);
}

TEST(ScanClosing, ThreadsDoNotMatter) {
  const OrientedPointCloud can = can_cloud(2000);
  SsdParams params;
  params.coarsest_nodes = 25000;  // the thread sanitizer makes a node dear
  const auto with_threads = [&](int n) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n);
    return fit_ssd(can, params);
  };
  const SsdFit one = with_threads(1), three = with_threads(3);
  EXPECT_FALSE(one.report.holes.empty());
  for (const Vec3& x : can_cloud(200).points) EXPECT_EQ(one.psi.value(1.1 * x), three.psi.value(1.1 * x));
}

TEST(ScanHoles, TheWindingNumberJumpsByOneAcrossSamplesOfAnyArea) {
  constexpr int kSamples = 9000;  // along a spiral, evenly, as merged samples are
  std::vector<SsdSample> samples;
  for (int i = 0; i < kSamples; ++i) {
    const double z = 1 - (2 * i + 1.) / kSamples, u = i * std::numbers::pi * (3 - std::sqrt(5.)),
                 r = std::sqrt(1 - z * z);
    const Vec3 x(r * std::cos(u), r * std::sin(u), z);
    samples.push_back({20 * x, x, 0, .7 * 4 * std::numbers::pi * 400 / kSamples});
  }
  const ScaledWindingNumber w(samples);
  EXPECT_NEAR(w.scale(), .7, .02);
  EXPECT_NEAR(w(Vec3(3, 2, 1)), 1, .02);
  EXPECT_NEAR(w(Vec3(30, 2, 1)), 0, .05);
  EXPECT_NEAR(w.inner(), 1, .1);
}

}  // namespace
}  // namespace umtet::test
