#include "reconstruct/cloud/survey/local_noise.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet::test {
namespace {

/// A second scan of a third of the torus, moved by `offset`.
OrientedPointCloud two_scans(double offset) {
  OrientedPointCloud cloud = torus_cloud(12000);
  const OrientedPointCloud second = torus_cloud(12000, 2);
  for (std::size_t i = 0; i < second.points.size(); ++i) {
    if (second.points[i][0] < .5) continue;
    cloud.points.push_back(second.points[i] + Vec3(0, 0, offset));
    cloud.normals.push_back(second.normals[i]);
  }
  return cloud;
}

std::vector<double> noise_of(const OrientedPointCloud& cloud, double usual) {
  return local_noise(cloud, NeighbourTree(cloud.points), usual);
}

TEST(LocalNoise, CleanSamplesNoiseAndEdgesAreUsual) {
  EXPECT_TRUE(noise_of(torus_cloud(12000), 1e-4).empty());
  EXPECT_TRUE(noise_of(with_noise(torus_cloud(12000), .03), .03).empty());
  EXPECT_TRUE(noise_of(box_cloud(Vec3(1, .7, .1), .02), 1e-4).empty());
}

TEST(LocalNoise, TwoSheetsHaveTheirOffset) {
  const double offset = 1.5 * median_spacing(torus_cloud(12000).points) * 2;
  const OrientedPointCloud cloud = two_scans(offset);
  const std::vector<double> local = noise_of(cloud, 1e-4);
  ASSERT_EQ(local.size(), cloud.points.size());
  double top = 0, elsewhere = 0;
  int n_top = 0;
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Vec3& x = cloud.points[i];
    if (x[0] > .7 && std::abs(cloud.normals[i][2]) > .95) top += local[i], ++n_top;
    if (x[0] < .3) elsewhere = std::max(elsewhere, local[i]);
  }
  EXPECT_GT(top / n_top, .25 * offset) << "a sample sees more of its own sheet";
  EXPECT_LT(top / n_top, .55 * offset);
  EXPECT_LT(elsewhere, .1 * offset);
}

TEST(LocalNoise, OfAnotherCloudIsRefusedByTheFit) {
  SsdParams params;
  params.local_noise = {.1};
  EXPECT_THROW(fit_ssd(torus_cloud(1000), params), std::invalid_argument);
}

}  // namespace
}  // namespace umtet::test
