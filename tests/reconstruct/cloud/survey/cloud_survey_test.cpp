#include "reconstruct/cloud/survey/cloud_survey.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <limits>

#include "reconstruct/io/point_cloud_io.h"
#include "tests/support/clouds.h"
#include "tests/support/data_files.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

using test::sampled;

TEST(Survey, NoiseIsMeasuredWithinAFifth) {
  for (const OrientedPointCloud& exact : {test::torus_cloud(20000), sampled(testing::equation_9(), 50000)}) {
    const double diagonal = test::box_diagonal(exact.points);
    for (const double share : {0.002, 0.005, 0.01}) {
      const double sigma = share * diagonal;
      const OrientedPointCloud noisy = test::with_tilted_normals(test::with_noise(exact, sigma), 6);
      EXPECT_NEAR(noise_along_normals(noisy.points), sigma, 0.2 * sigma) << share;
      EXPECT_NEAR(noise_along_normals(noisy, NeighbourTree(noisy.points)), sigma, 0.2 * sigma) << share;
    }
    EXPECT_LT(noise_along_normals(exact.points), 1e-5 * diagonal);
  }
}

// Eq. (9) bends within a few of these samples: a quadric through 24 of them is off by .06 distances.
TEST(Survey, NormalsTellDetailFromNoise) {
  const OrientedPointCloud few = sampled(testing::equation_9(), 3000, 5);
  const double of_points = noise_along_normals(few.points);
  EXPECT_LT(noise_along_normals(few, NeighbourTree(few.points)), .5 * of_points);
  OrientedPointCloud without = few;
  without.normals.clear();
  EXPECT_EQ(noise_along_normals(without, NeighbourTree(few.points)), of_points);
}

TEST(Survey, ThicknessIsTheDistanceToTheOppositeSide) {
  const CloudSurvey torus = survey(test::torus_cloud(20000));
  ASSERT_TRUE(torus.thickness.has_value());
  EXPECT_NEAR((*torus.thickness)[2], 2 * test::kTorusr, 0.005);
  EXPECT_NEAR((*torus.thickness)[0], 2 * test::kTorusr, 0.01);
  EXPECT_GT(torus.thickness_found, 0.95);
}

TEST(Survey, NamesWhatIsWrong) {
  OrientedPointCloud cloud = test::torus_cloud(10000);
  cloud.normals[3].setZero();
  cloud.normals[4] *= 2;
  test::turn_some(cloud, 0.1);
  cloud.points.push_back(cloud.points[0]);
  cloud.points.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  cloud.points.emplace_back(100, 0, 0);
  cloud.normals.resize(cloud.points.size(), Vec3::UnitX());
  const CloudSurvey found = survey(cloud);
  EXPECT_EQ(found.n_points, 10003U);
  EXPECT_EQ(found.dropped.n_duplicates, 1U);
  EXPECT_EQ(found.dropped.n_not_finite, 1U);
  EXPECT_EQ(found.dropped.n_outliers, 1U);
  EXPECT_EQ(found.n_normals_zero, 1U);
  EXPECT_EQ(found.n_normals_not_unit, 1U);
  EXPECT_NEAR(found.diagonal, std::hypot(2.8, 2.8, 0.8), 0.02);
  EXPECT_NEAR(found.consistency, 0.82, 0.03);
  EXPECT_FALSE(found.thickness.has_value());
}

TEST(Survey, SpacingDensityAndOrigin) {
  OrientedPointCloud cloud;
  test::add_sphere(cloud, {0, 0, 0}, 1, 10000);
  const CloudSurvey near = survey(cloud);
  EXPECT_GT(near.volume, 0);
  EXPECT_LT(near.openness, 0.01);
  EXPECT_LT(near.density_variation, 1.5);  // a lattice
  EXPECT_LE(near.spacing[0], near.spacing[1]);
  EXPECT_LE(near.spacing[1], near.spacing[2]);
  EXPECT_LT(near.float_ulp_over_spacing, 1e-4);
  for (Vec3& x : cloud.points) x += Vec3(1e6, 0, 0);
  const CloudSurvey far = survey(cloud);
  EXPECT_GT(far.float_ulp_over_spacing, 1);
  EXPECT_LT(far.ulp_over_spacing, 1e-7);
  EXPECT_NEAR(far.spacing[1], near.spacing[1], 1e-6 * near.spacing[1]);
}

TEST(Survey, WorksWithoutNormals) {
  OrientedPointCloud cloud = test::torus_cloud(3000);
  cloud.normals.clear();
  const CloudSurvey found = survey(cloud);
  EXPECT_FALSE(found.has_normals);
  EXPECT_FALSE(found.thickness.has_value());
  EXPECT_GT(found.spacing[1], 0);
  cloud.points.resize(20);
  EXPECT_THROW(survey(cloud), std::invalid_argument);
  SurveyParams params;
  params.sampled_points = 1;
  params.orientation.neighbours = 0;
  EXPECT_EQ(problems(params).size(), 2U);
}

TEST(Survey, SurfacesHaveTwoDimensionsAndVolumesThree) {
  EXPECT_NEAR(correlation_dimension(test::torus_cloud(5000).points), 2, .2);
  EXPECT_NEAR(correlation_dimension(test::with_noise(test::torus_cloud(5000), .03).points), 2, .3);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> side(-1, 1);
  std::vector<Vec3> box;
  for (int i = 0; i < 5000; ++i) box.emplace_back(side(random), side(random), side(random));
  EXPECT_GT(correlation_dimension(box), 2.6);
}

TEST(Survey, DoesNotDependOnTheNumberOfThreads) {
  const OrientedPointCloud cloud = test::with_noise(test::torus_cloud(20000), 0.005);
  const CloudSurvey many = survey(cloud);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const CloudSurvey one = survey(cloud);
  EXPECT_EQ(one.noise, many.noise);
  EXPECT_EQ(one.consistency, many.consistency);
  EXPECT_EQ(one.thickness, many.thickness);
  EXPECT_EQ(one.spacing, many.spacing);
}

// The scans lie 0.06 mm (median) to 0.14 mm (rms) from the zippered mesh; units are metres.
TEST(Survey, NoiseOfRegisteredScans) {
  const auto file = test::real_cloud("bunny_scans.ply");
  if (!file) GTEST_SKIP() << "no real scans beside the checkout";
  const double noise = noise_along_normals(read_point_cloud(*file).cloud.points);
  EXPECT_GT(noise, 0.06e-3);
  EXPECT_LT(noise, 0.14e-3);
}

}  // namespace
}  // namespace umtet
