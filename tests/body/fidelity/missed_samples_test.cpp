#include "body/fidelity/missed_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace umtet {
namespace {

/// A row of 1000 samples one apart, on the mesh.
struct Row {
  Domain domain;
  std::vector<double> d = std::vector<double>(1000, 0);

  Row() {
    for (int i = 0; i < 1000; ++i) domain.cloud.points.emplace_back(i, 0, 0);
    domain.cloud_spacing = 1;
    domain.noise = .1;
    domain.shift = Vec3(0, 100, 0);
  }
  void move(int first, int last, double distance) { std::fill(d.begin() + first, d.begin() + last, distance); }
  SampleDistances measured(double h, double flatness) const { return sample_distances(domain, d, h, flatness / h); }
};

TEST(MissedSamples, NoiseIsNone) {
  Row row;
  for (std::size_t i = 0; i < row.d.size(); i += 50) row.d[i] = .35;  // one in 50, each alone
  const SampleDistances s = row.measured(2, .01);
  EXPECT_DOUBLE_EQ(s.missed_beyond, .3);
  EXPECT_EQ(s.n_missed_places, 0u);
}

TEST(MissedSamples, SomeBesideOneAnotherAreAPlace) {
  Row row;
  row.move(100, 120, .4);
  row.move(110, 111, .5);
  row.move(700, 740, .9);
  row.move(800, 809, .9);  // too few
  const SampleDistances s = row.measured(2, .01);
  ASSERT_EQ(s.n_missed_places, 2u);
  EXPECT_EQ(s.missed[0].n_samples, 40u);
  EXPECT_EQ(s.missed[0].distance, .9);
  EXPECT_EQ(s.missed[1].n_samples, 20u);
  EXPECT_EQ(s.missed[1].farthest, Vec3(110, 100, 0));
}

TEST(MissedSamples, FlatFacesExplainTheirOwnDistance) {
  Row row;
  row.move(0, 1000, .4);
  EXPECT_EQ(row.measured(2, .5).n_missed_places, 0u);
  EXPECT_EQ(row.measured(2, .01).n_missed_places, 1u);
}

TEST(MissedSamples, NothingExplainsMoreThanH) {
  Row row;
  row.domain.noise = 1;
  for (std::size_t i = 0; i < row.d.size(); i += 50) row.d[i] = 1.5;
  EXPECT_EQ(row.measured(2, .01).n_missed_places, 0u);
  const SampleDistances s = row.measured(1, .01);
  ASSERT_EQ(s.n_missed_places, 1u) << "99 % are not within h, and no ten are beside one another";
  EXPECT_EQ(s.missed[0].n_samples, 20u);
}

TEST(MissedSamples, MergedOnesCountAsOftenAsTheSamplesTheyStandFor) {
  Row row;
  row.move(0, 20, .4);
  row.domain.cloud.counts.assign(1000, 1);
  row.domain.cloud.spreads.assign(1000, .3);
  std::fill_n(row.domain.cloud.counts.begin(), 20, 49);
  EXPECT_EQ(before_merging(row.domain.cloud, {std::vector<double>(1000, .4)})[5], .5);
  const SampleDistances s = row.measured(2, .01);
  EXPECT_EQ(s.n_merged, 980u + 20 * 49);
  EXPECT_NEAR(s.rms, .4 / std::sqrt(2), 1e-12) << "half of the samples are off";
  EXPECT_EQ(s.p99, .4);
  std::fill_n(row.domain.cloud.counts.begin(), 1000, 100);
  std::fill_n(row.domain.cloud.counts.begin(), 20, 1);
  EXPECT_EQ(row.measured(2, .01).p99, 0) << "20 of 98,020 are";
}

TEST(MissedSamples, AFewAreListedAndAllAreCounted) {
  Row row;
  Domain& domain = row.domain;
  row.d.clear();
  domain.cloud.points.clear();
  for (int place = 0; place < 120; ++place) {
    for (int i = 0; i < 12; ++i) {
      domain.cloud.points.emplace_back(100 * place + i, 0, 0);
      row.d.push_back(1 + place);
    }
  }
  const SampleDistances s = row.measured(200, .01);
  EXPECT_EQ(s.n_missed_places, 120u);
  ASSERT_EQ(s.missed.size(), kListedMisses);
  EXPECT_EQ(s.missed.front().distance, 120);
}

}  // namespace
}  // namespace umtet
