#include "body/scan/level_set_fit.h"

#include <gtest/gtest.h>

#include <random>

#include "body/sizing/edge_length.h"
#include "reconstruct/solve/solve_error.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

LevelSetFit fit_of(OrientedPointCloud cloud) { return fit_level_set(cloud, {}, BodyOptions(), {}); }

TEST(LevelSetFit, PsiLeavesAsMuchAsThereIsNoise) {
  for (const double noise : {.01, .03}) {
    const LevelSetFit fit = fit_of(test::with_noise(test::torus_cloud(20000), noise));
    EXPECT_NEAR(fit.report.noise, noise, .1 * noise);
    EXPECT_NEAR(fit.report.fit.rms_value, noise, .15 * noise);
  }
}

TEST(LevelSetFit, TextureIsNoNoise) {
  // Waves three spacings long: quadrics through neighbours leave them, psi does not.
  OrientedPointCloud cloud = test::torus_cloud(30000);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double u = std::atan2(cloud.points[i].y(), cloud.points[i].x());
    cloud.points[i] += .01 * std::sin(60 * u) * cloud.normals[i];
  }
  const LevelSetFit fit = fit_of(cloud);
  EXPECT_LT(fit.report.noise, .006);
}

TEST(LevelSetFit, TwoSheetsBecomeOneSurface) {
  for (const double offset : {.02, .04, .06}) {  // .5 to 1.7 spacings
    OrientedPointCloud cloud = test::torus_cloud(12000);
    const OrientedPointCloud second = test::torus_cloud(12000, 2);
    for (std::size_t i = 0; i < second.points.size(); ++i) {
      if (second.points[i][0] < .5) continue;
      cloud.points.push_back(second.points[i] + Vec3(0, 0, offset));
      cloud.normals.push_back(second.normals[i]);
    }
    const LevelSet psi = fit_of(cloud).psi;
    for (double angle = -.5; angle <= .5; angle += .05) {
      int n_crossings = 0;
      double former = -1;
      for (double z = .3; z < .6; z += .005) {
        const double value = psi.value(Vec3(std::cos(angle), std::sin(angle), z));
        n_crossings += (value < 0) != (former < 0);
        former = value;
      }
      EXPECT_EQ(n_crossings, 1) << offset << ' ' << angle;
    }
  }
}

TEST(LevelSetFit, NoiseInABallIsNoBody) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> side(-1, 1);
  OrientedPointCloud cloud;
  while (cloud.points.size() < 5000) {
    const Vec3 x(side(random), side(random), side(random));
    if (x.norm() > 1) continue;
    cloud.points.push_back(x);
    cloud.normals.push_back(Vec3(x + .5 * Vec3(side(random), side(random), side(random))).normalized());
  }
  try {
    fit_of(cloud);
    FAIL() << "has a body";
  } catch (const SolveError& e) {
    EXPECT_NE(std::string(e.what()).find("no surface"), std::string::npos) << e.what();
  }
}

TEST(EdgeLength, IsNotBelowWhatNoiseShows) {
  OrientedPointCloud cloud = test::with_noise(test::torus_cloud(20000), .03);
  LevelSetFit fit = fit_level_set(cloud, {}, BodyOptions(), {});
  Domain domain;
  domain.cloud = std::move(cloud);
  domain.box = fit.psi.domain();
  domain.diagonal = 4.05;
  domain.fitted = domain.level_set = std::move(fit.psi);
  domain.noise = fit.report.noise;
  const EdgeLength choice = choose_edge_length(domain, BodyOptions());
  EXPECT_NEAR(choice.h, *domain.noise / .3, 1e-9);
  ASSERT_TRUE(choice.of_thin_parts);
  EXPECT_LT(*choice.of_thin_parts, choice.h);
  domain.noise = 0;
  const EdgeLength clean = choose_edge_length(domain, BodyOptions());
  EXPECT_FALSE(clean.of_thin_parts);
  EXPECT_EQ(clean.h, *choice.of_thin_parts);
}

}  // namespace
}  // namespace umtet
