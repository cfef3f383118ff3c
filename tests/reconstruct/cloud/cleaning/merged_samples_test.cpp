#include "reconstruct/cloud/cleaning/merged_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet::test {
namespace {

constexpr double kCell = .1;  // a quarter of the torus' radius

MergedSamples merged_in(const OrientedPointCloud& cloud, double edge) {
  return merged_samples(cloud, SampleCells(cloud.points, edge, core_box(cloud.points).middle));
}

OrientedPointCloud shuffled(const OrientedPointCloud& cloud) {
  std::vector<std::size_t> order(cloud.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(5));
  OrientedPointCloud other;
  for (const std::size_t i : order) {
    other.points.push_back(cloud.points[i]);
    other.normals.push_back(cloud.normals[i]);
  }
  return other;
}

TEST(MergedSamples, CountEverySampleOnce) {
  const OrientedPointCloud cloud = torus_cloud(50000);
  const OrientedPointCloud merged = merged_in(cloud, kCell).cloud;
  EXPECT_LT(merged.points.size(), 6000u);
  EXPECT_EQ(std::accumulate(merged.counts.begin(), merged.counts.end(), std::size_t{0}), cloud.points.size());
  EXPECT_EQ(merged.counts.size(), merged.points.size());
  EXPECT_EQ(merged.spreads.size(), merged.points.size());
}

TEST(MergedSamples, StayWhatTheyAreWhereTheyAreToldTo) {
  const OrientedPointCloud cloud = torus_cloud(50000);
  const OrientedPointCloud merged =
      merged_samples(cloud, SampleCells(cloud.points, kCell, core_box(cloud.points).middle), [](const Vec3& x) {
        return x[0] > 0;
      }).cloud;
  std::size_t n_single = 0;
  for (std::size_t i = 0; i < merged.points.size(); ++i) {
    if (merged.points[i][0] < kCell) continue;
    EXPECT_EQ(merged.counts[i], 1);
    EXPECT_EQ(merged.spreads[i], 0);
    ++n_single;
  }
  EXPECT_EQ(n_single, static_cast<std::size_t>(std::count_if(cloud.points.begin(), cloud.points.end(),
                                                             [](const Vec3& x) { return x[0] >= kCell; })));
  EXPECT_EQ(std::accumulate(merged.counts.begin(), merged.counts.end(), std::size_t{0}), cloud.points.size());
  EXPECT_LT(merged.points.size(), n_single + 5000);
}

TEST(MergedSamples, LieOnACurvedSurfaceToThirdOrder) {
  const auto farthest = [](const OrientedPointCloud& cloud) {
    double d = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (cloud.counts[i] >= 8) d = std::max(d, std::abs(torus_distance(cloud.points[i])));
    }
    return d;
  };
  const OrientedPointCloud cloud = torus_cloud(400000);
  const double coarse = farthest(merged_in(cloud, 2 * kCell).cloud), fine = farthest(merged_in(cloud, kCell).cloud);
  EXPECT_LT(coarse, .03 * 2 * kCell) << "the plain mean is off by .08 cells";
  EXPECT_LT(fine, coarse / 6) << "half the cell, an eighth of it";
}

TEST(MergedSamples, HaveTheNormalsOfTheSurface) {
  const OrientedPointCloud merged = merged_in(torus_cloud(50000), kCell / 2).cloud;
  for (std::size_t i = 0; i < merged.points.size(); ++i) {
    const Vec3& x = merged.points[i];
    const Vec3 ring = Vec3(x[0], x[1], 0).normalized() * kTorusR;
    EXPECT_NEAR(merged.normals[i].norm(), 1, 1e-12);
    EXPECT_GT(merged.normals[i].dot((x - ring).normalized()), .99);
  }
}

TEST(MergedSamples, KeepTheNoiseInTheirSpread) {
  const auto noise_of = [](const OrientedPointCloud& merged) {
    return noise_before_merging(merged, NeighbourTree(merged.points));
  };
  // Of a tenth of a cell up to its third, where cells divide the noise between them.
  for (const double noise : {.002, .004, .008}) {
    const OrientedPointCloud cloud = with_noise(torus_cloud(300000), noise);
    EXPECT_NEAR(noise_of(merged_in(cloud, .025).cloud), noise, .15 * noise);
    OrientedPointCloud merged = merged_in({cloud.points, {}}, .025).cloud;
    merged.normals = estimate_normals(merged.points, {}).normals;
    orient_normals(merged);
    EXPECT_NEAR(noise_of(merged), noise, .2 * noise) << "without normals";
  }
  EXPECT_LT(noise_of(merged_in(torus_cloud(300000), .025).cloud), .03 * .025);
}

TEST(MergedSamples, KeepTwoSheetsInACellApart) {
  OrientedPointCloud plate = box_cloud(Vec3(4, 4, .3 * kCell), .02);
  std::vector<std::uint32_t> faces;  // without its rim
  for (std::uint32_t i = 0; i < plate.points.size(); ++i)
    if (std::abs(plate.normals[i][2]) > .5) faces.push_back(i);
  keep_samples(plate, faces);
  // Between the sheets there is no border of cells.
  const MergedSamples both = merged_samples(plate, SampleCells(plate.points, kCell, Vec3(0, 0, -.5 * kCell)));
  EXPECT_GT(static_cast<double>(both.n_two_sided), .3 * static_cast<double>(both.cloud.points.size()) / 2);
  for (std::size_t i = 0; i < both.cloud.points.size(); ++i) {
    EXPECT_NEAR(both.cloud.points[i][2], both.cloud.normals[i][2] > 0 ? .3 * kCell : 0, 1e-9);
  }
  EXPECT_EQ(merged_in(torus_cloud(50000), kCell).n_two_sided, 0u);
}

TEST(MergedSamples, OfDifferentLabelsStayApart) {
  OrientedPointCloud cloud = torus_cloud(50000);
  for (const Vec3& x : cloud.points) cloud.labels.push_back(x[0] > .33 ? 1 : 7);
  const OrientedPointCloud merged = merged_in(cloud, kCell).cloud;
  for (std::size_t i = 0; i < merged.points.size(); ++i) {
    if (std::abs(merged.points[i][0] - .33) < .005) continue;  // where means may pass the border along a normal
    EXPECT_EQ(merged.labels[i], merged.points[i][0] > .33 ? 1 : 7);
  }
}

TEST(MergedSamples, CarryTheMeansOfWhatSamplesCarry) {
  OrientedPointCloud cloud;
  for (const double x : {.1, .2, .3, 5.}) {
    cloud.points.emplace_back(x, 0, 0);
    cloud.origins.emplace_back(x, 0, 10);
  }
  cloud.colours = {{10, 0, 0}, {20, 0, 0}, {31, 0, 0}, {7, 7, 7}};
  cloud.fields = {{"t", {1, std::nan(""), 3, 9}}};
  const OrientedPointCloud merged = merged_samples(cloud, SampleCells(cloud.points, 1, Vec3(0, -.5, -.5))).cloud;
  ASSERT_EQ(merged.points.size(), 2u);
  EXPECT_EQ(merged.counts, (std::vector<int>{3, 1}));
  EXPECT_NEAR(merged.points[0][0], .2, 1e-15);
  EXPECT_NEAR(merged.origins[0][0], .2, 1e-15);
  EXPECT_EQ(merged.colours[0], (Colour{20, 0, 0}));
  EXPECT_EQ(merged.fields[0].values[0], 2) << "of those that were measured";
  EXPECT_EQ(merged.points[1], cloud.points[3]) << "alone, bit by bit";
}

TEST(MergedSamples, DoNotDependOnTheOrderOfTheCloud) {
  const OrientedPointCloud cloud = with_noise(torus_cloud(60000), .01);
  const OrientedPointCloud a = merged_in(cloud, kCell).cloud, b = merged_in(shuffled(cloud), kCell).cloud;
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.counts, b.counts);
  EXPECT_EQ(a.spreads, b.spreads);
}

TEST(MergedSamples, FarOutliersAreCellsOfTheirOwnAndDoNotMakeCellsLarger) {
  OrientedPointCloud cloud = torus_cloud(30000);
  const CoreBox core = core_box(cloud.points);
  const std::size_t n_before = merged_in(cloud, kCell).cloud.points.size();
  for (const double far : {1e7, 1e9, 1e12}) {
    cloud.points.emplace_back(far, 0, 0);
    cloud.normals.emplace_back(1, 0, 0);
  }
  EXPECT_NEAR(core_box(cloud.points).diagonal, core.diagonal, .01 * core.diagonal);
  const OrientedPointCloud merged = merged_in(cloud, kCell).cloud;
  EXPECT_NEAR(static_cast<double>(merged.points.size()), static_cast<double>(n_before + 3), .05 * n_before);
  EXPECT_EQ(std::count_if(merged.points.begin(), merged.points.end(), [](const Vec3& x) { return x[0] > 1e6; }), 3);
}

TEST(CellsFor, LeaveAsManyCellsAsAreWanted) {
  const OrientedPointCloud cloud = torus_cloud(100000);
  const CoreBox core = core_box(cloud.points);
  for (const std::size_t fewest : {1000u, 10000u, 30000u}) {
    const SampleCells cells = cells_for(cloud.points, core, 10, fewest);
    EXPECT_GE(cells.size(), fewest * 9 / 10);
    EXPECT_LE(cells.size(), fewest * 2);
  }
  EXPECT_EQ(cells_for(cloud.points, core, .01, 10).edge(), .01) << "no larger than that";
}

TEST(RelativeCounts, MakeAreasOfCellsAsLargeAsTheSurfaceInThem) {
  const OrientedPointCloud cloud = torus_cloud(200000);
  const OrientedPointCloud merged = merged_in(cloud, kCell).cloud;
  const Neighbourhoods near(merged.points);
  NeighbourDistances distances = neighbour_distances(merged.points, near);
  const double whole = 4 * std::numbers::pi * std::numbers::pi * kTorusR * kTorusr;
  const auto error = [&](const std::vector<double>& areas) {
    double sum = 0;
    for (std::size_t i = 0; i < areas.size(); ++i) {
      const double right = whole * merged.counts[i] / static_cast<double>(cloud.points.size());
      sum += std::pow(areas[i] - right, 2);
    }
    return std::sqrt(sum / static_cast<double>(areas.size()));
  };
  const double by_neighbours = error(sample_areas(distances));
  distances.weights = relative_counts(merged.counts, near);
  EXPECT_LT(error(sample_areas(distances)), .4 * by_neighbours);
  EXPECT_NEAR(std::accumulate(distances.weights.begin(), distances.weights.end(), 0.) /
                  static_cast<double>(merged.points.size()),
              1, .05);
}

}  // namespace
}  // namespace umtet::test
