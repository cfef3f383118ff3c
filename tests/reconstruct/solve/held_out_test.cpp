#include "reconstruct/solve/held_out.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet::test {
namespace {

TEST(HeldOut, RightNormalsExplainOtherSamplesThroughNoise) {
  for (const double noise : {0., .03, .1}) {
    const OrientedPointCloud known = with_noise(torus_cloud(1500), noise, 1),
                             others = with_noise(torus_cloud(500, 2), noise, 2);
    const HeldOutResidual right = held_out_residual(known, others, noise);
    EXPECT_LT(right.normal_defect, .15) << noise;
    EXPECT_LT(right.opposed_share, .01) << noise;
    EXPECT_LT(right.rms_value, 1.3 * noise + .01) << noise;
  }
}

TEST(HeldOut, TurnedPatchesExplainThemWorse) {
  for (const double noise : {0., .03}) {
    OrientedPointCloud known = with_noise(torus_cloud(1500), noise, 1),
                       others = with_noise(torus_cloud(500, 2), noise, 2);
    const HeldOutResidual right = held_out_residual(known, others, noise);
    for (OrientedPointCloud* cloud : {&known, &others})
      for (std::size_t i = 0; i < cloud->points.size(); ++i)
        if (cloud->points[i].x() > .9) cloud->normals[i] = -cloud->normals[i];
    const HeldOutResidual wrong = held_out_residual(known, others, noise);
    EXPECT_GT(wrong.energy(), right.energy()) << noise;
    EXPECT_GT(wrong.normal_defect, 2 * right.normal_defect) << noise;
  }
}

TEST(HeldOut, SheetsASpacingApartAreNoSingleOne) {
  OrientedPointCloud known = box_cloud({2, 2, .05}, .05), others = known;
  for (Vec3& x : others.points) x += Vec3(.02, .02, 0);
  const double two = held_out_residual(known, others, 0).energy();
  for (OrientedPointCloud* cloud : {&known, &others})
    for (Vec3& n : cloud->normals)
      if (n.z() < 0) n = -n;
  EXPECT_GT(held_out_residual(known, others, 0).energy(), 1.5 * two);
}

TEST(HeldOut, NeedsSamplesThatMeasure) {
  EXPECT_THROW(held_out_residual(torus_cloud(200), {}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace umtet::test
