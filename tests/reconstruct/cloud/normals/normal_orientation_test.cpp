#include "reconstruct/cloud/normals/normal_orientation.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>

#include "reconstruct/cloud/normals/detail/sign_turning.h"
#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/cloud/normals/scanner_positions.h"
#include "reconstruct/cloud/normals/sign_graph.h"
#include "reconstruct/io/point_cloud_io.h"
#include "tests/support/clouds.h"
#include "tests/support/data_files.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

using test::sampled;

std::size_t n_wrong(const OrientedPointCloud& cloud, const std::vector<Vec3>& truth) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) wrong += cloud.normals[i].dot(truth[i]) > 0 ? 0 : 1;
  return wrong;
}

TEST(OrientNormals, RandomSignsOfTheAnalyticDomainsBecomeOutward) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    OrientedPointCloud cloud = sampled(domain, 15000);
    const std::vector<Vec3> truth = cloud.normals;
    cloud.normals = estimate_normals(cloud.points).normals;
    test::turn_some(cloud, 0.5);
    const OrientationReport report = orient_normals(cloud);
    EXPECT_LE(n_wrong(cloud, truth), 15U) << domain.name;  // one in a thousand
    EXPECT_LT(report.consistency, 0.55) << domain.name;
    EXPECT_GT(report.consistency_after, 0.998) << domain.name;
    EXPECT_EQ(report.n_components, static_cast<std::size_t>(domain.components)) << domain.name;
  }
}

TEST(OrientNormals, NoiseLeavesOneInAThousand) {
  OrientedPointCloud cloud = sampled(testing::equation_9(), 20000);
  const std::vector<Vec3> truth = cloud.normals;
  cloud = test::with_noise(cloud, 0.005 * test::box_diagonal(cloud.points));
  cloud.normals = estimate_normals(cloud.points).normals;
  orient_normals(cloud);
  EXPECT_LE(n_wrong(cloud, truth), 20U);
}

TEST(OrientNormals, BodiesFaceOutwardAndCavitiesInward) {
  OrientedPointCloud cloud = test::torus_cloud(20000);
  test::add_sphere(cloud, {1, 0, 0}, 0.2, 5000, -1);  // a bubble in the torus
  test::add_sphere(cloud, {1, 0, 0}, 0.1, 3000);      // a grain in the bubble
  test::add_sphere(cloud, {3, 0, 0}, 0.3, 5000);      // beside it
  test::add_sphere(cloud, {0, 0, 0}, 0.57, 5000);     // in its hole, a spacing from it: outside
  const std::vector<Vec3> truth = cloud.normals;
  test::turn_some(cloud, 0.5);
  const OrientationReport report = orient_normals(cloud);
  EXPECT_EQ(n_wrong(cloud, truth), 0U);
  EXPECT_EQ(report.n_components, 5U);
  EXPECT_EQ(report.n_cavities, 1U);
  EXPECT_EQ(report.n_doubtful, 0U);
}

// The rim is as round as the spacing: neighbours across it must not be joined as if they lay on one sheet.
TEST(OrientNormals, TheSidesOfAThinPlateStayApart) {
  OrientedPointCloud cloud = sampled(testing::ellipsoid({1, 1, 0.1}), 40000);
  const std::vector<Vec3> truth = cloud.normals;
  test::turn_some(cloud, 0.5);
  const OrientationReport report = orient_normals(cloud);
  EXPECT_LE(n_wrong(cloud, truth), 40U);
  EXPECT_EQ(report.n_components, 1U);
  EXPECT_EQ(report.n_doubtful, 0U);
}

// Thinner than that the samples do not say how the sides are joined, and the volume shows that they are not.
TEST(OrientNormals, APlateThatIsTooThinIsDoubtful) {
  OrientedPointCloud cloud = sampled(testing::ellipsoid({1, 1, 0.02}), 40000);
  const std::vector<Vec3> truth = cloud.normals;
  test::turn_some(cloud, 0.5);
  const OrientationReport report = orient_normals(cloud);
  EXPECT_TRUE(n_wrong(cloud, truth) <= 40 || report.n_doubtful > 39000) << report.n_doubtful;
}

TEST(OrientNormals, AnOpenSheetIsAGuessAndSaysSo) {
  OrientedPointCloud cloud = test::plane_cloud(50, Vec3::UnitZ());
  test::turn_some(cloud, 0.5);
  const OrientationReport report = orient_normals(cloud);
  EXPECT_EQ(report.n_doubtful, 2500U);
  EXPECT_EQ(report.consistency_after, 1);
}

TEST(OrientNormals, DoesNotDependOnTheNumberOfThreads) {
  OrientedPointCloud many = test::with_noise(test::torus_cloud(20000), 0.02);
  test::turn_some(many, 0.5);
  OrientedPointCloud one = many;
  orient_normals(many);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  orient_normals(one);
  EXPECT_EQ(one.normals, many.normals);
}

TEST(RepairNormals, RightNormalsAreLeftAloneBitForBit) {
  for (const double noise : {0.0, 0.005, 0.01}) {
    OrientedPointCloud cloud = sampled(testing::equation_9(), 20000);
    cloud = test::with_noise(cloud, noise * test::box_diagonal(cloud.points));
    const std::vector<Vec3> given = cloud.normals;
    const OrientationReport report = repair_normals(cloud);
    EXPECT_EQ(cloud.normals, given);
    EXPECT_TRUE(report.left_alone);
    EXPECT_EQ(report.consistency, report.consistency_after);
  }
}

// 1, 2 and 3 hold together more than any of them is held against; their border is in disagreement.
TEST(SignGraph, PatchesTurnTogetherThatNoneLeavesAlone) {
  const std::vector<SignEdge> edges = {{0, 1, 0.6F}, {1, 2, 1}, {2, 3, 1}, {3, 4, -0.9F}, {0, 4, 1}};
  const std::vector<std::uint32_t> single = {0, 1, 2, 3, 4};
  std::vector<std::int8_t> sign(5, 1);
  turn_groups(SignAdjacency(5, edges), single, 5, sign);
  EXPECT_EQ(sign, std::vector<std::int8_t>(5, 1));
  turn_regions(edges, single, 5, sign);
  EXPECT_EQ(sign[0] * sign[4], 1);
  for (const std::size_t i : {1U, 2U, 3U}) EXPECT_EQ(sign[i] * sign[0], -1) << i;
  const std::vector<std::int8_t> best = sign;
  turn_regions(edges, single, 5, sign);
  EXPECT_EQ(sign, best);
}

// What is left alone without a solve must have no region that is turned, however small.
TEST(RepairNormals, NoTurnedRegionGoesUncontested) {
  const OrientedPointCloud right = test::torus_cloud(20000);
  const Neighbourhoods near(right.points);
  EXPECT_EQ(sign_agreement(right, near).n_contested, 0U);
  for (const double radius : {0.01, 0.05, 0.2, 0.5}) {
    OrientedPointCloud cloud = right;
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      if ((cloud.points[i] - right.points[7]).norm() < radius) cloud.normals[i] = -cloud.normals[i];
    EXPECT_GT(sign_agreement(cloud, near).n_contested, 0U) << radius;
    repair_normals(cloud, {}, &near);
    EXPECT_EQ(cloud.normals, right.normals) << radius;
  }
}

TEST(RepairNormals, NeighbourhoodsOfAnotherCloudAreRefused) {
  OrientedPointCloud cloud = test::torus_cloud(500);
  const Neighbourhoods fewer(test::torus_cloud(499).points), wider(cloud.points, 13), right(cloud.points);
  EXPECT_THROW(repair_normals(cloud, {}, &fewer), std::invalid_argument);
  EXPECT_THROW(repair_normals(cloud, {}, &wider), std::invalid_argument);
  EXPECT_EQ(consistency(cloud, {}, &right), consistency(cloud));
}

TEST(RepairNormals, AMinorityIsTurnedBack) {
  OrientedPointCloud cloud = sampled(testing::equation_9(), 20000);
  const std::vector<Vec3> truth = cloud.normals;
  std::size_t n_patch = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (cloud.points[i].x() > 0.8) {
      cloud.normals[i] = -cloud.normals[i];
      ++n_patch;
    }
  const OrientedPointCloud patched = cloud;
  const OrientationReport patch = repair_normals(cloud);
  EXPECT_EQ(cloud.normals, truth);
  EXPECT_EQ(patch.n_turned, n_patch);

  cloud = patched;
  test::turn_some(cloud, 0.1);
  EXPECT_LT(consistency(cloud), 0.85);
  repair_normals(cloud);
  EXPECT_EQ(cloud.normals, truth);
}

TEST(RepairNormals, AnInwardCloudIsTurnedOutward) {
  OrientedPointCloud cloud = test::torus_cloud(5000);
  const std::vector<Vec3> truth = cloud.normals;
  flip(cloud);
  EXPECT_EQ(repair_normals(cloud).n_turned, 5000U);
  EXPECT_EQ(cloud.normals, truth);
}

// The cap of a sphere has a volume about its centroid, whose sign must not win against most of the given normals.
TEST(RepairNormals, WithoutAVolumeTheMajorityDecides) {
  OrientedPointCloud sphere;
  test::add_sphere(sphere, {0, 0, 0}, 1, 8000);
  for (const double side : {-1.0, 1.0}) {
    OrientedPointCloud cap;
    for (std::size_t i = 0; i < sphere.points.size(); ++i)
      if (sphere.points[i].z() > 0.5) {
        cap.points.push_back(sphere.points[i]);
        cap.normals.push_back(side * sphere.normals[i]);
      }
    const std::vector<Vec3> truth = cap.normals;
    test::turn_some(cap, 0.3);
    EXPECT_EQ(repair_normals(cap).n_doubtful, truth.size());
    EXPECT_EQ(cap.normals, truth);
  }
}

// Pairs across a gap of a third of the spacing say that one of the two is turned over.
TEST(RepairNormals, ABodyThatTouchesAnotherStaysAsItCame) {
  for (const double spacings : {0.1, 0.3, 1.0}) {
    OrientedPointCloud cloud = test::torus_cloud(20000);
    const double gap = spacings * 0.028;  // sqrt(area / 20000)
    test::add_sphere(cloud, {1.4 + gap + 0.3, 0, 0}, 0.3, 1400);
    const std::vector<Vec3> given = cloud.normals;
    EXPECT_TRUE(repair_normals(cloud).left_alone) << spacings;
    EXPECT_EQ(cloud.normals, given) << spacings;
  }
}

// Equal ones enclose nothing when one of them is turned over: what they are left with tells their sides.
TEST(RepairNormals, SpheresThatTouchAreNoGuess) {
  for (const double gap : {0.0, 0.01}) {
    OrientedPointCloud cloud;
    for (const double side : {-1.0, 1.0}) test::add_sphere(cloud, {side * (1 + gap / 2), 0, 0}, 1, 5000);
    const std::vector<Vec3> given = cloud.normals;
    const OrientationReport report = repair_normals(cloud);
    EXPECT_EQ(report.n_components, 1U) << "no pairs across the gap";
    EXPECT_EQ(report.n_doubtful, 0U) << gap;
    EXPECT_TRUE(report.left_alone) << gap;
    EXPECT_EQ(cloud.normals, given) << gap;
  }
}

TEST(RepairNormals, OneInAThousandIsTurnedBackOnSmoothPlaces) {
  for (const OrientedPointCloud& right : {test::torus_cloud(20000), sampled(testing::equation_9(), 20000)}) {
    OrientedPointCloud cloud = right;
    test::turn_some(cloud, 0.001);
    EXPECT_GT(consistency(cloud), 0.99);
    repair_normals(cloud);
    EXPECT_EQ(cloud.normals, right.normals);
  }
}

TEST(OrientFrom, EveryNormalLooksAtItsNearestViewpoint) {
  OrientedPointCloud cloud;
  cloud.points = {{0, 0, 0}, {10, 0, 0}};
  cloud.normals = {Vec3::UnitZ(), Vec3::UnitZ()};
  EXPECT_EQ(orient_from(cloud, {{0, 0, 5}, {10, 0, -5}}), 1U);
  EXPECT_EQ(cloud.normals[0], Vec3::UnitZ());
  EXPECT_EQ(cloud.normals[1], -Vec3::UnitZ());
  EXPECT_THROW(orient_from(cloud, {}), std::invalid_argument);
  cloud.normals.pop_back();
  EXPECT_THROW(orient_normals(cloud), std::invalid_argument);
  EXPECT_THROW(repair_normals(cloud, {.neighbours = 2, .disagreement = 2}), std::invalid_argument);
}

TEST(RepairNormals, RealScansAreLeftAloneAndThePenguinIsRepaired) {
  if (!test::real_cloud("penguin_flipped_normals.ply")) GTEST_SKIP() << "no real scans beside the checkout";
  OrientedPointCloud penguin = read_point_cloud(*test::real_cloud("penguin_flipped_normals.ply")).cloud;
  const OrientationReport report = repair_normals(penguin);
  EXPECT_EQ(report.n_turned, 4242U);  // what the data's README says was turned
  EXPECT_GT(report.consistency_after, 0.999);
  for (const char* name : {"duck.ply", "blub.xyz", "skull.ply", "scorpion.ply", "bunny_holes.pcd"}) {
    OrientedPointCloud cloud = read_point_cloud(*test::real_cloud(name)).cloud;
    const std::vector<Vec3> given = cloud.normals;
    EXPECT_TRUE(repair_normals(cloud).left_alone) << name;
    EXPECT_EQ(cloud.normals, given) << name;
  }
}

TEST(OrientNormals, RealCloudsWithoutTheirNormals) {
  for (const auto& [name, share] :
       {std::pair{"duck.ply", 0.999}, std::pair{"armadillo.ply", 0.9995}, std::pair{"scorpion.ply", 0.999},
        std::pair{"skull.ply", 0.999}, std::pair{"blub.xyz", 0.994}}) {
    const auto file = test::real_cloud(name);
    if (!file) GTEST_SKIP() << "no real scans beside the checkout";
    OrientedPointCloud cloud = read_point_cloud(*file).cloud;
    const std::vector<Vec3> truth = cloud.normals;
    cloud.normals = estimate_normals(cloud.points).normals;
    orient_normals(cloud);
    EXPECT_LE(static_cast<double>(n_wrong(cloud, truth)), (1 - share) * static_cast<double>(truth.size())) << name;
  }
}

}  // namespace
}  // namespace umtet
