#include "reconstruct/solve/outer_wall.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruct/solve/fit_ssd.h"

namespace umtet::test {
namespace {

/// A tube along z, open at both ends: two cylinders and the two rings between them.
OrientedPointCloud pipe_cloud(double inner, double length, double spacing) {
  OrientedPointCloud cloud;
  const double outer = 1;
  const auto add = [&](double r, double u, double z, const Vec3& n) {
    cloud.points.emplace_back(r * std::cos(u), r * std::sin(u), z);
    cloud.normals.push_back(n);
  };
  const int around = static_cast<int>(2 * std::numbers::pi / spacing), along = static_cast<int>(length / spacing);
  const int across = std::max(2, static_cast<int>((outer - inner) / spacing));
  for (int a = 0; a < around; ++a) {
    const double u = 2 * std::numbers::pi * a / around;
    const Vec3 radial(std::cos(u), std::sin(u), 0);
    for (int k = 0; k <= along; ++k) {
      add(outer, u, length * k / along, radial);
      add(inner, u, length * k / along, -radial);
    }
    for (int k = 1; k < across; ++k) {
      const double r = inner + (outer - inner) * k / across;
      add(r, u, 0, -Vec3::UnitZ());
      add(r, u, length, Vec3::UnitZ());
    }
  }
  return cloud;
}

TEST(OuterWall, SamplesThatBoundABodyKeepPsiInside) {
  const OrientedPointCloud pipe = pipe_cloud(.7, 12, .2);
  SsdParams params;
  EXPECT_LT(fit_ssd(pipe, params).report.least_wall_value, 0);
  params.bounded = true;
  const SsdFit fit = fit_ssd(pipe, params);
  EXPECT_GT(fit.report.least_wall_value, 0);
  EXPECT_LT(fit.psi.value({.85, 0, 6}), 0);
  EXPECT_GT(fit.psi.value({0, 0, 6}), 0);
}

TEST(OuterWall, AFitThatStaysInsideIsUnchanged) {
  const OrientedPointCloud pipe = pipe_cloud(.4, 1, .1);
  SsdParams params;
  const SsdFit free = fit_ssd(pipe, params);
  ASSERT_GT(free.report.least_wall_value, 0);
  params.bounded = true;
  EXPECT_EQ(fit_ssd(pipe, params).psi.value({.2, .3, .4}), free.psi.value({.2, .3, .4}));
}

TEST(OuterWall, SamplesLieInTheOutermostCellsAtTheirDistance) {
  Lattice lattice;
  lattice.origin = Vec3::Zero();
  lattice.h = .5;
  lattice.n = {6, 7, 8};
  SsdSample middle;
  middle.xi = Vec3(2.5, 3, 3.5);
  const std::vector<SsdSample> samples = wall_samples(lattice, {middle});
  EXPECT_EQ(samples.size(), 5U * 6 * 7 - 3 * 4 * 5);
  for (const SsdSample& s : samples) {
    EXPECT_DOUBLE_EQ(s.value, (s.xi - middle.xi).norm());
    EXPECT_EQ(s.w_gradient, 0);
  }
}

}  // namespace
}  // namespace umtet::test
