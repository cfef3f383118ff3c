#include "reconstruct/winding/winding_outliers.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruct/cloud/neighbours/morton_order.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet::test {
namespace {

std::vector<std::uint8_t> outliers_of(OrientedPointCloud& cloud) {
  sort_in_space(cloud);
  return winding_outliers(cloud, Neighbourhoods(cloud.points));
}

TEST(WindingOutliers, ThoseOfAVolumeGoAndTheSurfaceStays) {
  OrientedPointCloud cloud = torus_cloud(20000);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> side(-1.6, 1.6);
  for (int i = 0; i < 1000; ++i) {
    cloud.points.emplace_back(side(random), side(random), side(random));
    cloud.normals.push_back(Vec3(side(random), side(random), side(random)).normalized());
  }
  const std::vector<std::uint8_t> is_outlier = outliers_of(cloud);
  std::size_t n_far = 0, n_found = 0, n_wrong = 0;
  for (std::size_t i = 0; i < is_outlier.size(); ++i) {
    const double d = std::abs(torus_distance(cloud.points[i]));
    const bool is_far = d > .12;  // four spacings
    n_far += is_far ? 1 : 0;
    n_found += is_far && is_outlier[i] != 0 ? 1 : 0;
    n_wrong += d < 1e-9 && is_outlier[i] != 0 ? 1 : 0;
  }
  EXPECT_GT(n_far, 700u);
  EXPECT_GT(static_cast<double>(n_found), .99 * static_cast<double>(n_far));
  EXPECT_EQ(n_wrong, 0u);
}

TEST(WindingOutliers, AreFoundAmongMergedSamplesByWhatTheseStandFor) {
  OrientedPointCloud cloud = torus_cloud(20000);
  cloud.counts.assign(20000, 30);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> side(-1.6, 1.6);
  for (int i = 0; i < 3000; ++i) {  // a fifth as near to each other as the samples of the surface now
    cloud.points.emplace_back(side(random), side(random), side(random) / 3);
    cloud.normals.push_back(Vec3(side(random), side(random), side(random)).normalized());
    cloud.counts.push_back(1);
  }
  const auto share_found = [](OrientedPointCloud& some) {
    const std::vector<std::uint8_t> is_outlier = outliers_of(some);
    std::size_t n_far = 0, n_found = 0;
    for (std::size_t i = 0; i < is_outlier.size(); ++i) {
      const bool is_far = std::abs(torus_distance(some.points[i])) > .12;
      n_far += is_far ? 1 : 0;
      n_found += is_far && is_outlier[i] != 0 ? 1 : 0;
    }
    return static_cast<double>(n_found) / static_cast<double>(n_far);
  };
  OrientedPointCloud unknown = cloud;
  unknown.counts = {};
  EXPECT_GT(share_found(cloud), .97);
  EXPECT_LT(share_found(unknown), .9);
}

TEST(WindingOutliers, BodiesOfAnyDensityHaveNone) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  OrientedPointCloud torus = torus_cloud(60000), falling;
  for (std::size_t i = 0; i < torus.points.size(); ++i) {
    if (unit(random) > std::pow(100, -(torus.points[i][0] + 1.4) / 2.8)) continue;
    falling.points.push_back(torus.points[i]);
    falling.normals.push_back(torus.normals[i]);
  }
  OrientedPointCloud box = box_cloud(Vec3(1, .7, .02), .02), noisy = with_noise(torus_cloud(20000), .02);
  for (OrientedPointCloud* cloud : {&falling, &box}) {
    const std::vector<std::uint8_t> found = outliers_of(*cloud);
    EXPECT_EQ(std::count(found.begin(), found.end(), 1), 0) << cloud->points.size();
  }
  const std::vector<std::uint8_t> found = outliers_of(noisy);
  EXPECT_LT(std::count(found.begin(), found.end(), 1), 20);
}

}  // namespace
}  // namespace umtet::test
