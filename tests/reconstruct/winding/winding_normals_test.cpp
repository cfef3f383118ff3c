#include "reconstruct/winding/winding_normals.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "tests/reconstruct/winding/winding_clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

using test::n_wrong, test::rms_angle_deg, test::spread, test::thin_plate;

std::vector<Vec3> from_nothing(const OrientedPointCloud& cloud) {
  return winding_normals(cloud.points, sample_areas(cloud.points));
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

double patches_off(const OrientedPointCloud& cloud, double noise) {
  return patches_off_a_half(cloud.points, cloud.normals, sample_areas(cloud.points), noise);
}

TEST(PatchesOffAHalf, AreFewWhateverTheNoiseWhereSidesAreRight) {
  constexpr double kSpacing = .063;  // of 4000 points of the torus
  for (const double spacings : {0., .25, .5, 1., 1.7}) {
    const double noise = spacings * kSpacing;
    for (const std::uint64_t seed : {1, 2}) {
      const OrientedPointCloud cloud = test::with_noise(test::torus_cloud(4000, seed), noise, seed);
      EXPECT_LT(patches_off(cloud, noise), .02) << spacings << ' ' << seed;
      if (spacings > .4)
        EXPECT_GT(off_a_half(cloud.points, cloud.normals, sample_areas(cloud.points)), .1) << "single samples are";
    }
  }
}

TEST(PatchesOffAHalf, AreThoseThatLookToTheWrongSide) {
  for (const double noise : {0., .03, .06}) {
    OrientedPointCloud cloud = test::with_noise(test::torus_cloud(4000), noise);
    std::size_t n_turned = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (cloud.points[i].x() < .9) continue;
      cloud.normals[i] = -cloud.normals[i];
      ++n_turned;
    }
    EXPECT_GT(patches_off(cloud, noise), .5 * static_cast<double>(n_turned) / 4000) << noise;
  }
}

TEST(PatchesOffAHalf, AreAllOfASingleSheet) {
  OrientedPointCloud plate = thin_plate(.1);
  EXPECT_LT(patches_off(plate, .05), .05);
  for (Vec3& n : plate.normals)
    if (n.z() < 0) n = -n;
  EXPECT_GT(patches_off(plate, .05), .8);
}

}  // namespace
}  // namespace umtet
