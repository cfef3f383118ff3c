#include "reconstruct/cloud/cleaning/covering.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "reconstruct/cloud/cleaning/cleaning.h"
#include "reconstruct/cloud/neighbours/morton_order.h"
#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

constexpr double kGap = .07;

/// The unit ball in lines `ratio` times denser along than across, sorted in space like every cloud that is prepared.
OrientedPointCloud ball(double ratio) {
  OrientedPointCloud cloud = test::ball_in_lines(kGap, ratio);
  sort_in_space(cloud);
  return cloud;
}

Covering covering_of(const OrientedPointCloud& cloud) { return covering(cloud.points, Neighbourhoods(cloud.points)); }

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(Covering, EvenCloudsAreTheirOwn) {
  OrientedPointCloud spiral;
  test::add_sphere(spiral, Vec3::Zero(), 1, 3000);
  OrientedPointCloud holed = test::torus_cloud(20000);
  std::erase_if(holed.points, [](const Vec3& x) { return (x - Vec3(1.4, 0, 0)).norm() < .5; });
  for (const OrientedPointCloud& cloud :
       {spiral, test::torus_cloud(20000), holed, test::box_cloud(Vec3(1, .7, .02), .02),
        test::plane_cloud(50, Vec3::UnitZ()), test::with_noise(test::torus_cloud(20000), .005),
        test::with_noise(test::torus_cloud(20000), .05), ball(1), ball(3)})
    EXPECT_TRUE(covering_of(cloud).is_even()) << cloud.points.size();
}

TEST(Covering, EveryPointIsWithinAGapOfItsRepresentative) {
  for (const double ratio : {6., 10., 30., 100.}) {
    const OrientedPointCloud cloud = ball(ratio);
    const Covering lines = covering_of(cloud);
    ASSERT_FALSE(lines.is_even());
    EXPECT_EQ(std::accumulate(lines.n_represented.begin(), lines.n_represented.end(), std::size_t{0}),
              cloud.points.size());
    EXPECT_TRUE(std::is_sorted(lines.chosen.begin(), lines.chosen.end()));
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const std::uint32_t r = lines.chosen[lines.representative[i]];
      EXPECT_LT((cloud.points[i] - cloud.points[r]).norm(), 2 * kGap);
      EXPECT_EQ(lines.chosen[lines.representative[r]], r);
    }
  }
}

TEST(Covering, TheDistanceBetweenSamplesIsLikeTheGapForAnyDensityAlongLines) {
  for (const double ratio : {6., 10., 30., 100.}) {
    const OrientedPointCloud cloud = ball(ratio);
    const double spacing = sample_spacing(covered_distances(cloud.points));
    EXPECT_GT(spacing, .25 * kGap) << ratio;
    EXPECT_LT(spacing, .8 * kGap) << ratio;
  }
}

TEST(Covering, AreasOfLinesAddUpToTheSurface) {
  for (const double ratio : {1., 3., 6., 10., 30., 100.})
    EXPECT_NEAR(sum(sample_areas(covered_distances(ball(ratio).points))), 4 * std::numbers::pi,
                .2 * 4 * std::numbers::pi)
        << ratio;
}

TEST(Covering, AWireIsLeftWithSomeRepresentatives) {
  std::vector<Vec3> wire;
  for (int i = 0; i < 2000; ++i) wire.push_back(.001 * i * Vec3(1, 2, 3));
  EXPECT_GE(covering(wire, Neighbourhoods(wire)).chosen.size(), 60);
  wire.resize(12);
  EXPECT_TRUE(covering(wire, Neighbourhoods(wire)).is_even());
}

TEST(Covering, DoesNotDependOnTheNumberOfThreads) {
  const OrientedPointCloud cloud = ball(20);
  const Covering many = covering_of(cloud);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const Covering one = covering_of(cloud);
  EXPECT_EQ(many.chosen, one.chosen);
  EXPECT_EQ(many.representative, one.representative);
}

TEST(Covering, SearchedDistancesAreThoseOfKnownNeighbours) {
  for (const double ratio : {1., 20.}) {
    const OrientedPointCloud cloud = ball(ratio);
    const Neighbourhoods near(cloud.points);
    const NeighbourDistances known = neighbour_distances(cloud.points, near, covering(cloud.points, near)),
                             searched = covered_distances(cloud.points);
    EXPECT_EQ(known.mean_square, searched.mean_square);
    EXPECT_EQ(known.multiplicity, searched.multiplicity);
    EXPECT_EQ(known.representatives, searched.representatives);
  }
  EXPECT_THROW(covered_distances({}), std::invalid_argument);
  EXPECT_THROW(covered_distances(std::vector<Vec3>(20, Vec3::Ones())), std::invalid_argument);
}

TEST(Covering, CleaningKeepsLinesAndDropsOutliers) {
  for (const double ratio : {10., 30.}) {
    OrientedPointCloud cloud = ball(ratio);
    const std::size_t n = cloud.points.size();
    EXPECT_EQ(clean(cloud).kept.size(), n);
    OrientedPointCloud with = cloud;
    test::add_sphere(with, Vec3(3, 0, 0), .01, 30);
    for (int i = 0; i < 40; ++i) with.points.emplace_back(.1 + .01 * i, .3 * std::cos(i), .3 * std::sin(i));
    with.normals.resize(with.points.size(), Vec3::UnitX());
    const CleaningReport report = clean(with);
    EXPECT_GE(report.n_outliers + report.n_small_components, 60) << ratio;
    EXPECT_GE(report.kept.size(), n) << ratio;
  }
}

TEST(Covering, NormalsOfLinesAreEstimatedAndOrientedAcrossGaps) {
  for (const double ratio : {10., 30.}) {
    const OrientedPointCloud truth = ball(ratio);
    OrientedPointCloud cloud = truth;
    const Neighbourhoods near(cloud.points);
    const Covering lines = covering(cloud.points, near);
    cloud.normals = estimate_normals(cloud.points, {}, &lines).normals;
    const OrientationReport report = orient_normals(cloud, {}, &near, &lines);
    EXPECT_EQ(report.n_components, 1) << ratio;
    EXPECT_EQ(report.n_doubtful, 0) << ratio;
    for (std::size_t i = 0; i < truth.points.size(); ++i)
      EXPECT_GT(cloud.normals[i].dot(truth.normals[i]), std::cos(3 * std::numbers::pi / 180)) << ratio;
  }
}

TEST(Covering, RepairTurnsPatchesOfLinesBackAndLeavesTheRest) {
  const OrientedPointCloud truth = ball(20);
  const Neighbourhoods near(truth.points);
  const Covering lines = covering(truth.points, near);
  OrientedPointCloud cloud = truth;
  EXPECT_TRUE(repair_normals(cloud, {}, &near, &lines).left_alone);
  EXPECT_EQ(consistency(cloud, {}, &near, &lines), 1);
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.points[i].z() > .8 || i % 20 == 0) cloud.normals[i] = -cloud.normals[i];
  EXPECT_LT(consistency(cloud, {}, &near, &lines), 1);
  repair_normals(cloud, {}, &near, &lines);
  for (std::size_t i = 0; i < truth.points.size(); ++i) EXPECT_EQ(cloud.normals[i], truth.normals[i]);
}

}  // namespace
}  // namespace umtet
