#include "reconstruct/winding/winding_normals.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/cloud/morton_order.h"
#include "reconstruct/cloud/normal_estimation.h"
#include "reconstruct/cloud/normal_orientation.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

std::size_t n_wrong(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) wrong += normals[i].dot(truth[i]) > 0 ? 0 : 1;
  return wrong;
}

double rms_angle_deg(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    sum += std::pow(std::acos(std::clamp(normals[i].dot(truth[i]), -1., 1.)), 2);
  return std::sqrt(sum / static_cast<double>(truth.size())) * 180 / std::numbers::pi;
}

/// n of its samples, each farthest from those before.
OrientedPointCloud spread(const OrientedPointCloud& cloud, std::size_t n) {
  OrientedPointCloud few;
  std::vector<double> distance2(cloud.points.size(), 1e300);
  for (std::size_t next = 0; few.points.size() < n;) {
    few.points.push_back(cloud.points[next]);
    few.normals.push_back(cloud.normals[next]);
    for (std::size_t i = 0; i < distance2.size(); ++i)
      distance2[i] = std::min(distance2[i], (cloud.points[i] - few.points.back()).squaredNorm());
    next = static_cast<std::size_t>(std::max_element(distance2.begin(), distance2.end()) - distance2.begin());
  }
  return few;
}

std::vector<Vec3> from_nothing(const OrientedPointCloud& cloud) {
  return winding_normals(cloud.points, sample_areas(cloud.points));
}

OrientedPointCloud sorted(OrientedPointCloud cloud) {
  sort_in_space(cloud);
  return cloud;
}

/// Two sheets and their rim, a spacing apart: neighbours of a sample are on both.
OrientedPointCloud thin_plate(double spacing) {
  return test::box_cloud({40 * spacing, 40 * spacing, spacing}, spacing);
}

TEST(WindingNormals, FiftyPointsOfATorusHaveTheirNormals) {
  const OrientedPointCloud cloud = spread(test::torus_cloud(500), 50);
  const std::vector<Vec3> normals = from_nothing(cloud);
  EXPECT_EQ(n_wrong(normals, cloud.normals), 0U);
  EXPECT_LT(rms_angle_deg(normals, cloud.normals), 15);
}

TEST(WindingNormals, AThousandPointsHaveThemForAllDomains) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    const OrientedPointCloud cloud = spread(test::sampled(domain, 4000), 1000);
    const std::vector<Vec3> normals = from_nothing(cloud);
    EXPECT_LE(n_wrong(normals, cloud.normals), 5U) << domain.name;
    EXPECT_LT(rms_angle_deg(normals, cloud.normals), 20) << domain.name;
  }
}

TEST(WindingNormals, SheetsOneSpacingApartFaceOutward) {
  const OrientedPointCloud cloud = thin_plate(0.1);
  const std::vector<Vec3> normals = from_nothing(cloud);
  EXPECT_LE(n_wrong(normals, cloud.normals), cloud.points.size() / 100);
}

TEST(WindingNormals, ChangeNeitherWithUnitNorWithThreads) {
  const OrientedPointCloud cloud = test::torus_cloud(1000);
  OrientedPointCloud larger = cloud;
  for (Vec3& x : larger.points) x *= 1024;
  const std::vector<Vec3> normals = from_nothing(cloud);
  EXPECT_LT(rms_angle_deg(from_nothing(larger), normals), 1e-3);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(from_nothing(cloud), normals);
}

TEST(OrientByWinding, RightNormalsAreLeftAlone) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    OrientedPointCloud cloud = sorted(test::sampled(domain, 8000));
    const std::vector<Vec3> truth = cloud.normals;
    const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true});
    EXPECT_FALSE(report.taken) << domain.name;
    EXPECT_LT(report.off_before, 0.04) << domain.name;
    EXPECT_EQ(cloud.normals, truth) << domain.name;
  }
}

TEST(OrientByWinding, TurnsWhatIsWrongAndKeepsDirections) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(8000));
  const std::vector<Vec3> truth = cloud.normals;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (cloud.points[i].x() > 0.3) cloud.normals[i] = -truth[i];
  const WindingReport report = orient_by_winding(cloud, {});
  EXPECT_TRUE(report.taken);
  EXPECT_TRUE(report.is_closed());
  EXPECT_GT(report.n_turned, 2000U);
  EXPECT_EQ(report.n_replaced, 0U);
  EXPECT_EQ(cloud.normals, truth);
}

TEST(OrientByWinding, SparseCloudsWithoutNormalsComeOutRight) {
  for (const std::size_t n : {50, 200}) {
    OrientedPointCloud cloud = sorted(spread(test::torus_cloud(2000), n));
    const std::vector<Vec3> truth = cloud.normals;
    cloud.normals = estimate_normals(cloud.points).normals;
    orient_normals(cloud);
    orient_by_winding(cloud, {.directions_may_change = true});
    EXPECT_EQ(n_wrong(cloud.normals, truth), 0U) << n;
  }
}

TEST(OrientByWinding, ThinPlatesWithoutNormalsComeOutRight) {
  OrientedPointCloud cloud = sorted(thin_plate(0.1));
  const std::vector<Vec3> truth = cloud.normals;
  cloud.normals = estimate_normals(cloud.points).normals;
  orient_normals(cloud);
  orient_by_winding(cloud, {.directions_may_change = true});
  EXPECT_LE(n_wrong(cloud.normals, truth), truth.size() / 100);
}

TEST(OrientByWinding, SoDoThoseWithManySamples) {
  OrientedPointCloud cloud = sorted(test::box_cloud({4, 4, 0.05}, 0.05));
  const std::vector<Vec3> truth = cloud.normals;
  ASSERT_GT(truth.size(), 12000U);
  for (Vec3& n : cloud.normals)
    if (n.z() < 0) n = -n;  // as of a single sheet
  EXPECT_TRUE(orient_by_winding(cloud, {.directions_may_change = true}).taken);
  EXPECT_LE(n_wrong(cloud.normals, truth), truth.size() / 100);
}

TEST(OrientByWinding, TakesOthersBackThatAreBetter) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(8000));
  const std::vector<Vec3> truth = cloud.normals;
  for (std::size_t i = 0; i < truth.size(); i += 2) cloud.normals[i] = -truth[i];
  const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true, .others = &truth});
  EXPECT_TRUE(report.restored);
  EXPECT_FALSE(report.taken);
  EXPECT_EQ(cloud.normals, truth);
  const std::vector<Vec3> few(3, Vec3::UnitX());
  cloud.normals.assign(truth.size(), Vec3::UnitX());
  EXPECT_THROW(orient_by_winding(cloud, {.directions_may_change = true, .others = &few}), std::invalid_argument);
}

TEST(OrientByWinding, ZeroNormalsStay) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(2000));
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) cloud.normals[i] *= i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : -1;
  orient_by_winding(cloud, {.directions_may_change = true});
  for (std::size_t i = 0; i < cloud.normals.size(); i += 3) EXPECT_TRUE(cloud.normals[i].isZero(0));
}

}  // namespace
}  // namespace umtet
