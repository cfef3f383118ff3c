#include "reconstruct/cloud/cleaning/cleaning.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <limits>
#include <random>

#include "reconstruct/io/point_cloud_io.h"
#include "tests/support/clouds.h"
#include "tests/support/data_files.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

using test::sampled;

TEST(Clean, DropsWhatIsNoNumberAndWhatIsThereTwice) {
  OrientedPointCloud cloud = test::torus_cloud(2000);
  const OrientedPointCloud original = cloud;
  cloud.points.insert(cloud.points.begin() + 7, Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0));
  cloud.normals.insert(cloud.normals.begin() + 7, Vec3::UnitX());
  cloud.points.emplace_back(1e101, 0, 0);
  cloud.normals.push_back(Vec3::UnitX());
  for (int i = 0; i < 5; ++i) {  // the first of the two stays, with its normal
    cloud.points.push_back(original.points[static_cast<std::size_t>(i)]);
    cloud.normals.push_back(Vec3::UnitY());
  }
  const CleaningReport report = clean(cloud);
  EXPECT_EQ(report.n_not_finite, 2U);
  EXPECT_EQ(report.n_duplicates, 5U);
  EXPECT_EQ(report.n_outliers + report.n_small_components, 0U);
  EXPECT_EQ(cloud.points, original.points);
  EXPECT_EQ(cloud.normals, original.normals);
  OrientedPointCloud again = cloud;
  again.points.push_back(cloud.points.front());
  again.normals.push_back(cloud.normals.front());
  Neighbourhoods near;  // of what is left
  clean(again, {}, &near);
  EXPECT_EQ(near.size(), 2000U);
  EXPECT_GT(near.distance2(again.points, 0, 0), 0);
  ASSERT_EQ(report.kept.size(), 2000U);
  EXPECT_EQ(report.kept[6], 6U);
  EXPECT_EQ(report.kept[7], 8U);
}

// The cloud: eq. (9), noise of half a per cent of the diagonal, a hundredth of outliers in the box.
TEST(Clean, OutliersGoAndSamplesStay) {
  constexpr std::uint32_t kSamples = 50000, kOutliers = 500;
  const OrientedPointCloud exact = sampled(testing::equation_9(), kSamples);
  const double sigma = 0.005 * test::box_diagonal(exact.points);
  OrientedPointCloud cloud = test::with_outliers(test::with_noise(exact, sigma), kOutliers);
  const OrientedPointCloud original = cloud;
  const CleaningReport report = clean(cloud);
  std::uint32_t samples = 0, junk = 0, far_junk = 0;
  for (const std::uint32_t i : report.kept) {
    if (i < kSamples) {
      ++samples;
      continue;
    }
    ++junk;
    double nearest2 = std::numeric_limits<double>::infinity();
    for (const Vec3& x : exact.points) nearest2 = std::min(nearest2, (x - original.points[i]).squaredNorm());
    if (nearest2 > 64 * sigma * sigma) ++far_junk;
  }
  EXPECT_GE(samples, kSamples - kSamples / 1000);
  EXPECT_LE(far_junk, 20U);  // what stays is within the noise of the surface, or between its walls
  EXPECT_LE(junk, 150U);
}

TEST(Clean, CleanCloudsLoseNothingWhateverTheirDensity) {
  OrientedPointCloud eq9 = sampled(testing::equation_9(), 20000);
  EXPECT_EQ(clean(eq9).kept.size(), 20000U);

  OrientedPointCloud varied;  // density e^4 : 1 from pole to pole
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  while (varied.points.size() < 20000) {
    const Vec3 n = Vec3(gauss(random), gauss(random), gauss(random)).normalized();
    if (unit(random) < std::exp(-2 * (1 + n.z()))) varied.points.push_back(n);
  }
  EXPECT_EQ(clean(varied).kept.size(), 20000U);
  EXPECT_TRUE(varied.normals.empty());

  // Ten scans over one half, one over the other: a step of ten in density.
  OrientedPointCloud scans;
  for (int scan = 0; scan < 10; ++scan)
    for (const Vec3& x : test::torus_cloud(4000, 20 + static_cast<std::uint64_t>(scan)).points)
      if (scan == 0 || x.x() > 0) scans.points.push_back(x);
  const std::size_t n = scans.points.size();
  EXPECT_EQ(clean(scans).kept.size(), n);
}

TEST(Clean, OnePointFarAwayDoesNotHideTheOthers) {
  OrientedPointCloud cloud = test::with_outliers(test::torus_cloud(10000), 50);
  OrientedPointCloud with_far = cloud;
  with_far.points.emplace_back(3e6, 0, 0);
  with_far.normals.push_back(Vec3::UnitX());
  clean(cloud);
  clean(with_far);
  EXPECT_LT(cloud.points.size(), 10030U);
  EXPECT_EQ(cloud.points, with_far.points);
}

TEST(Clean, CrumbsFarFromTheRestGoAndSmallPartsNearItStay) {
  OrientedPointCloud cloud = test::torus_cloud(20000);
  test::add_sphere(cloud, {0, 0, 0}, 0.05, 60);     // small and far: gap .55, its spacing .02
  test::add_sphere(cloud, {3, 0, 0}, 0.3, 2000);    // far and not small
  test::add_sphere(cloud, {0, 1, 0.74}, 0.09, 60);  // small and near: gap .25, six of its spacings of .04
  const CleaningReport report = clean(cloud);
  EXPECT_EQ(report.n_small_component_pieces, 1U);
  EXPECT_EQ(report.n_small_components, 60U);
  EXPECT_EQ(report.kept.size(), 22060U);
}

TEST(Clean, KeepsAllOnRequest) {
  OrientedPointCloud cloud = test::with_outliers(test::torus_cloud(5000), 50);
  CleaningParams params;
  params.outliers = false;
  EXPECT_EQ(clean(cloud, params).kept.size(), 5050U);
}

TEST(Clean, DoesNotDependOnTheNumberOfThreads) {
  const OrientedPointCloud cloud = test::with_outliers(test::torus_cloud(20000), 400);
  OrientedPointCloud many = cloud, one = cloud;
  const CleaningReport report = clean(many);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(report.kept, clean(one).kept);
}

TEST(Clean, RefusesWhatItCannotUse) {
  OrientedPointCloud cloud = test::torus_cloud(100);
  cloud.normals.pop_back();
  EXPECT_THROW(clean(cloud), std::invalid_argument);
  CleaningParams params;
  params.suspicious_crowd = 1;
  params.certain_crowd = 0;
  params.small_component_distance = 0;
  EXPECT_EQ(problems(params).size(), 3U);
}

TEST(Clean, RealScansLoseNextToNothing) {
  for (const char* name : {"armadillo.ply", "koala.ply", "scorpion.ply", "skull.ply", "bunny_holes.pcd"}) {
    const auto file = test::real_cloud(name);
    if (!file) GTEST_SKIP() << "no real scans beside the checkout";
    OrientedPointCloud cloud = read_point_cloud(*file).cloud;
    const CleaningReport report = clean(cloud);
    EXPECT_EQ(report.n_outliers + report.n_small_components, 0U) << name;
  }
}

}  // namespace
}  // namespace umtet
