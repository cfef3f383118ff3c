// Thin parts are as thick in psi as in the samples.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "body/scan/level_set_fit.h"

namespace umtet {
namespace {

constexpr double kSpacing = .02;

/// A blade of 1 x 1 whose thickness runs linearly over x, from `back` to `edge`; samples about kSpacing apart.
struct Blade {
  double back, edge;
  double thickness(double x) const { return back + (edge - back) * x; }
  Vec3 side_normal(double side) const { return Vec3(.5 * (back - edge), 0, side).normalized(); }
};

OrientedPointCloud samples_of(const Blade& blade, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> jitter(.2, .8);
  OrientedPointCloud cloud;
  const auto add = [&](const Vec3& x, const Vec3& n) {
    cloud.points.push_back(x);
    cloud.normals.push_back(n);
  };
  const int n = static_cast<int>(std::lround(1 / kSpacing));
  for (const double side : {-1., 1.}) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double x = (i + jitter(random)) / n, y = (j + jitter(random)) / n;
        add({x, y, side * .5 * blade.thickness(x)}, blade.side_normal(side));
      }
      const double along = (i + jitter(random)) / n;
      for (const auto& [at, normal] : {std::pair{Vec3(along, .5 + .5 * side, 0), Vec3(0, side, 0)},
                                       {Vec3(.5 + .5 * side, along, 0), Vec3(side, 0, 0)}}) {
        const double t = blade.thickness(at.x());
        const int n_across = std::max(1, static_cast<int>(std::lround(t / kSpacing)));
        for (int k = 0; k < n_across; ++k) {
          add(at + Vec3(0, 0, t * ((k + jitter(random)) / n_across - .5)), normal);
        }
      }
    }
  }
  return cloud;
}

/// How thick psi is at (x, y), looked at up to `reach` to either side.
double thickness_of(const LevelSet& psi, double x, double y, double reach) {
  constexpr int kSteps = 400;
  int n_inside = 0;
  for (int k = 0; k < kSteps; ++k) n_inside += psi.value({x, y, reach * (2 * (k + .5) / kSteps - 1)}) < 0;
  return 2 * reach * n_inside / kSteps;
}

void expect_thickness(const Blade& blade, double from_x, double to_x) {
  OrientedPointCloud cloud = samples_of(blade, 1);
  const LevelSet psi = fit_level_set(cloud, {}, BodyOptions(), {}).psi;
  for (double x = from_x; x <= to_x; x += .1) {
    for (double y = .15; y < .9; y += .1) {
      const double t = blade.thickness(x);
      EXPECT_NEAR(thickness_of(psi, x, y, 2 * t), t, .1 * t)
          << "blade of " << blade.back / kSpacing << " to " << blade.edge / kSpacing << " spacings at " << x << ' '
          << y;
    }
  }
}

TEST(ThinParts, PlatesOfOneToThreeSpacingsAreAsThickAsTheirSamples) {
  for (const double spacings : {1., 1.5, 2., 3.}) {
    expect_thickness({spacings * kSpacing, spacings * kSpacing}, .15, .85);
  }
}

TEST(ThinParts, BladesAreAsThickAsTheirSamplesDownToOneSpacing) {
  expect_thickness({3 * kSpacing, .2 * kSpacing}, .1, .7);  // a spacing thick at x = .71
  expect_thickness({6 * kSpacing, 1 * kSpacing}, .1, .9);
}

}  // namespace
}  // namespace umtet
