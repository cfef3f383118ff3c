// Samples that are merged for a lattice, and which of them it resolves.

#include "reconstruct/solve/ssd_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "reconstruct/solve/multilevel_fit.h"
#include "tests/support/clouds.h"

using namespace umtet;
using namespace umtet::test;

TEST(MergeSamples, MeanOfASphereKnowsItsDistance) {
  // Samples of a cap that a cube holds: their mean lies inside the sphere by a quarter of the cap's height, and its
  // value says so to third order.
  std::vector<SsdSample> cap;
  const double radius = 5;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.04 * std::sqrt((i + 0.5) / 400), a = 2.399963 * i;
    const Vec3 n(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
    cap.push_back({Vec3(10.25, 10.25, 10.25 - radius) + radius * n, n, 1, 1, 0});
  }
  const std::vector<SsdSample> mean = merge_samples(cap, 0.5);
  ASSERT_EQ(mean.size(), 1u);
  const double distance = (mean[0].xi - Vec3(10.25, 10.25, 10.25 - radius)).norm() - radius;
  EXPECT_LT(distance, -1e-3);
  EXPECT_NEAR(mean[0].value, distance, 1e-3 * std::abs(distance));
  EXPECT_EQ(mean[0].w_value, 400);
}

TEST(MergeSamples, KeepsWeightsAndOrdersByBlock) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 40);
  std::vector<SsdSample> samples(5000);
  for (SsdSample& s : samples) s = {Vec3(unit(random), unit(random), unit(random)), Vec3::UnitX(), 2, 1, 0};
  const std::vector<SsdSample> merged = merge_samples(samples, 1);
  EXPECT_LT(merged.size(), samples.size());
  double weight = 0;
  std::vector<std::array<int, 3>> blocks;
  for (const SsdSample& s : merged) {
    weight += s.w_value;
    const Eigen::Vector3i b = (s.xi / 8).array().floor().cast<int>();
    if (blocks.empty() || blocks.back() != std::array{b[2], b[1], b[0]}) blocks.push_back({b[2], b[1], b[0]});
  }
  EXPECT_NEAR(weight, 10000, 1e-9);
  EXPECT_TRUE(std::is_sorted(blocks.begin(), blocks.end()));  // each block once
}

TEST(ResolvedSamples, LeavesSparseCellsToTheCoarserLevels) {
  std::vector<SsdSample> samples;
  const auto add = [&](const Vec3& xi, double area) { samples.push_back({xi, Vec3::UnitX(), area, area, 0}); };
  add({1.2, 1.2, 1.2}, 1), add({1.7, 1.2, 1.2}, 9);    // one of the cell's samples is dense enough: both stay
  add({3.2, 1.2, 1.2}, 9), add({20.5, 3.5, 3.5}, 30);  // alone
  const std::vector<SsdSample> kept = resolved_samples(samples, 4);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[1].w_value, 9);
}

TEST(ResolvedSamples, ThoseOfAScanLineAreResolvedWhenItsGapIs) {
  std::vector<SsdSample> line;
  for (int i = 0; i < 16; ++i)
    line.push_back({{1.25 + .5 * (i % 2), 1.2, 1.2}, Vec3::UnitX(), .5, .5, 0, i < 8 ? 3. : 5.});
  EXPECT_EQ(resolved_samples(line, 4).size(), 16u);
  for (SsdSample& s : line) s.gap2 = 5;
  EXPECT_TRUE(resolved_samples(line, 4).empty());
}
