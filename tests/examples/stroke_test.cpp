// Figs. 24 to 26: the swimmer of Section 4.3 over a stroke, at the size of the figures.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "examples/swimmer/channel_mesher.h"
#include "examples/swimmer/swim_files.h"

namespace umtet {
namespace {

TEST(Figure24, TheFluidAroundTheSwimmerIsMeshedAtEveryInstantShown) {
  const ChannelMesher mesher(300000);
  for (const double t : {-7., -4., 0., 3., 5., 8.}) {
    const FluidMesh fluid = mesher(Swimmer(t, 0));  // throws unless certified
    const double q = min_quality(fluid, mesher.tets());
    std::printf("t0 + %g: %zu tets, min Q %.3f\n", t + 8, fluid.tets.size(), q);
    EXPECT_GE(q, .7);
  }
}

TEST(Figure25, PressureIsHighAheadAndLowBehind) {
  const ChannelMesher mesher(300000);
  SwimParams params;
  params.t0 = -1;
  params.steps = 1;
  const SwimObserver observer = [&](const SwimStep& step, const FluidMesh& fluid, const ForceFreeMotion& motion) {
    double ahead = 0, behind = 0, fastest = 0;
    for (const int t : fluid.tets) {
      for (const int v : mesher.tets()[t]) {
        const Vec3& x = fluid.V[v];
        if (x.z() > 0) ahead = std::max(ahead, motion.translation.p[v]);
        if (x.z() < 0) behind = std::min(behind, motion.translation.p[v]);
        fastest = std::max(fastest, motion.translation.u[v].norm());
      }
    }
    std::printf("t = %g: pressures %.3f to %.3f, speeds up to %.4f\n", step.t, behind, ahead, fastest);
    EXPECT_GT(ahead, 0);
    EXPECT_LT(behind, 0);
    EXPECT_LT(fastest, 1.02);  // the body's own is 1
    const Swimmer swimmer(step.t, step.z0);
    for (const int v : fluid.swimmer) {
      EXPECT_LT((motion.deformation.u[v] - swimmer.deformation_velocity(fluid.V[v])).norm(), 1e-12);
      EXPECT_EQ(motion.translation.u[v], Vec3::UnitZ());
    }
    for (const int v : fluid.walls) EXPECT_EQ(motion.translation.u[v], Vec3::Zero());
    return false;
  };
  swim(mesher.n_vertices(), mesher.tets(), mesher, params, observer);
}

TEST(Figure26, TheSwimmerGoesBackwardsOverAStroke) {
  const ChannelMesher mesher(300000);
  SwimParams params;
  params.dt = 2;
  params.steps = 8;
  const std::vector<SwimStep> steps = swim(mesher.n_vertices(), mesher.tets(), mesher, params);
  ASSERT_EQ(steps.size(), 9u);
  for (const SwimStep& s : steps) std::printf("t = %g: z0' = %.4f, z0 = %.4f\n", s.t, s.velocity, s.z0);
  // With steps of one: from -.014 to .019 at t = -5 and .015 at t = -4, -.181 at t = 1, -.026 at the end, and z0 =
  // -1.02.
  EXPECT_GT(steps[2].velocity, .01);  // t = -4
  const auto fastest = std::min_element(steps.begin(), steps.end(),
                                        [](const SwimStep& a, const SwimStep& b) { return a.velocity < b.velocity; });
  EXPECT_NEAR(fastest->velocity, -.18, .02);
  EXPECT_NEAR(fastest->t, 1, 1);
  EXPECT_NEAR(steps.back().z0, -1.02, .15);
}

}  // namespace
}  // namespace umtet
