#include "reconstruct/solve/noise_bias.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet::test {
namespace {

TEST(NoiseBias, IsTheNoiseSquaredTimesTheMeanCurvature) {
  const OrientedPointCloud cloud = torus_cloud(3000);
  const LevelSet psi = fit_ssd(cloud).psi;
  // The integral of H over a torus is 2 pi^2 R, its area 4 pi^2 R r.
  EXPECT_NEAR(noise_bias(psi, cloud, .1), .01 / (2 * kTorusr), .001);
  EXPECT_EQ(noise_bias(psi, cloud, 0), 0);
}

TEST(NoiseBias, IsWhatIsotropicNoiseAddsToABody) {
  constexpr double kNoise = .1;  // 1.4 spacings
  const OrientedPointCloud cloud = with_noise(torus_cloud(3000), kNoise);
  SsdParams params;
  params.noise = kNoise;
  const LevelSet psi = fit_ssd(cloud, params).psi, moved = shifted(psi, noise_bias(psi, cloud, kNoise));
  double before = 0, after = 0;  // of the truth, over its samples
  const OrientedPointCloud truth = torus_cloud(1000, 2);
  for (const Vec3& x : truth.points) before += psi.value(x) / 1000, after += moved.value(x) / 1000;
  EXPECT_LT(before, -.005);
  EXPECT_LT(std::abs(after), .6 * std::abs(before)) << "the rest is of areas behind samples, which grow outward";
}

TEST(NoiseBias, AShiftIsAConstant) {
  const OrientedPointCloud cloud = torus_cloud(3000);
  const LevelSet psi = fit_ssd(cloud).psi, moved = shifted(psi, .01);
  for (std::size_t i = 0; i < cloud.points.size(); i += 100)
    EXPECT_NEAR(moved.value(cloud.points[i]) - psi.value(cloud.points[i]), .01, 1e-6);
}

}  // namespace
}  // namespace umtet::test
