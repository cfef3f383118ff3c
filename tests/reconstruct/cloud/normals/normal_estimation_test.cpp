#include "reconstruct/cloud/normals/normal_estimation.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

using test::sampled;

double rms_degrees(const std::vector<Vec3>& estimated, const std::vector<Vec3>& exact) {
  double sum = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(estimated[i].norm(), 1, 1e-12);
    const double angle = std::acos(std::min(1.0, std::abs(estimated[i].dot(exact[i]))));
    sum += angle * angle;
  }
  return std::sqrt(sum / static_cast<double>(exact.size())) * 180 / std::numbers::pi;
}

TEST(EstimateNormals, AreThoseOfCleanSurfaces) {
  const OrientedPointCloud torus = test::torus_cloud(20000), eq9 = sampled(testing::equation_9(), 20000);
  const EstimatedNormals estimated = estimate_normals(torus.points);
  EXPECT_LT(rms_degrees(estimated.normals, torus.normals), 0.1);
  EXPECT_EQ(estimated.n_widened, 0U);
  EXPECT_EQ(estimated.n_undefined, 0U);
  EXPECT_LT(rms_degrees(estimate_normals(eq9.points).normals, eq9.normals), 1);
}

// Half a per cent of the diagonal is as large as the spacing here: 24 neighbours fill a ball, not a disc.
TEST(EstimateNormals, WidenWhereThereIsNoise) {
  const OrientedPointCloud torus = test::torus_cloud(20000), eq9 = sampled(testing::equation_9(), 50000);
  const auto noisy = [](const OrientedPointCloud& cloud) {
    return test::with_noise(cloud, 0.005 * test::box_diagonal(cloud.points)).points;
  };
  const EstimatedNormals estimated = estimate_normals(noisy(torus));
  EXPECT_LT(rms_degrees(estimated.normals, torus.normals), 5);
  EXPECT_GT(estimated.n_widened, 19000U);
  EXPECT_LT(rms_degrees(estimate_normals(noisy(eq9)).normals, eq9.normals), 6.3);
}

// A plate two spacings thick: 24 neighbours reach through it, and their plane is anything.
TEST(EstimateNormals, TellTheSidesOfAThinPlateApart) {
  OrientedPointCloud plate;
  for (const double side : {-1.0, 1.0})
    for (Vec3 x : test::plane_cloud(40, Vec3::UnitZ()).points) {
      plate.points.push_back(x + Vec3(0.004 * side, 0.003 * side, 0.025 * side));
      plate.normals.push_back(side * Vec3::UnitZ());
    }
  EXPECT_LT(rms_degrees(estimate_normals(plate.points).normals, plate.normals), 2);
}

TEST(EstimateNormals, KnowNoUnitAndNoOrigin) {
  const OrientedPointCloud torus = test::torus_cloud(2000);
  const std::vector<Vec3> normals = estimate_normals(torus.points).normals;
  std::vector<Vec3> scaled = torus.points, moved = torus.points;
  for (Vec3& x : scaled) x *= 0x1p-60;
  for (Vec3& x : moved) x += Vec3(1e7, -1e7, 1e7);
  EXPECT_EQ(estimate_normals(scaled).normals, normals);
  const std::vector<Vec3> there = estimate_normals(moved).normals;
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_GT(std::abs(there[i].dot(normals[i])), 1 - 1e-10);
}

TEST(EstimateNormals, DoNotDependOnTheNumberOfThreads) {
  const std::vector<Vec3> points = test::with_noise(test::torus_cloud(20000), 0.01).points;
  const std::vector<Vec3> many = estimate_normals(points).normals;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(estimate_normals(points).normals, many);
}

TEST(EstimateNormals, AreZeroWhereAllIsOnePlace) {
  std::vector<Vec3> points = test::torus_cloud(100).points;
  points.insert(points.end(), 40, Vec3(5, 5, 5));
  EXPECT_EQ(estimate_normals(points).n_undefined, 40U);
  EXPECT_THROW(estimate_normals({Vec3::Zero(), Vec3::Ones()}), std::invalid_argument);
  NormalEstimationParams params;
  params.neighbours = 3;
  params.noise_angle = 0;
  params.largest_growth = 0.5;
  EXPECT_EQ(problems(params).size(), 3U);
  EXPECT_THROW(estimate_normals(points, params), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
