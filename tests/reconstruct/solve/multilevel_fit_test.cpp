// The multilevel fit: the sum of levels.

#include "reconstruct/solve/multilevel_fit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"

using namespace umtet;
using namespace umtet::test;

namespace {

const SsdFit& torus_fit() {
  static const SsdFit fit = [] {
    SsdParams p;
    p.spacing = 0.08;
    p.coarsest_nodes = 8000;
    return fit_ssd(torus_cloud(8000), p);
  }();
  return fit;
}

}  // namespace

TEST(MultilevelFit, MeetsItsAccuracyOnTheTorus) {
  SsdParams p;
  p.spacing = 0.4 / 14;
  p.coarsest_nodes = 20000;
  const SsdFit fit = fit_ssd(torus_cloud(20000), p);
  ASSERT_GE(fit.psi.n_levels(), 2);
  const double h = fit.report.spacing, r = kTorusr;
  double mean = 0, normal2 = 0, curvature2 = 0;
  const OrientedPointCloud truth = torus_cloud(1500, 77);
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    Vec3 g;
    Mat3 H;
    const double f = fit.psi.evaluate(truth.points[i], &g, &H);
    mean += std::abs(f) / g.norm();
    const Vec3 n = g.normalized();
    normal2 += (n - truth.normals[i]).squaredNorm();
    const double ring = std::hypot(truth.points[i][0], truth.points[i][1]);
    const double exact = 1 / r + (ring - kTorusR) / (r * ring);
    const double found = (H.trace() - n.dot(H * n)) / g.norm();
    curvature2 += std::pow(found / exact - 1, 2);
  }
  const auto n = static_cast<double>(truth.points.size());
  EXPECT_LT(mean / n, 3e-4 * h);
  EXPECT_LT(std::sqrt(normal2 / n), 5e-4);
  EXPECT_LT(std::sqrt(curvature2 / n), 0.05);
  for (const BandReport& band : fit.report.bands) EXPECT_LE(band.iterations, 20);
}

TEST(MultilevelFit, DerivativesPassFiniteDifferencesAndAreContinuous) {
  const LevelSet& psi = torus_fit().psi;
  const double e = 1e-5, h = psi.spacing();
  for (const Vec3& x : torus_cloud(40, 11).points) {
    Vec3 g;
    Mat3 H;
    const double f = psi.evaluate(x, &g, &H);
    double sum = 0;
    for (int level = 0; level < psi.n_levels(); ++level) sum += psi.evaluate_level(level, x, nullptr, nullptr);
    EXPECT_NEAR(f, sum, 1e-15);
    EXPECT_EQ(f, psi.value(x));
    EXPECT_EQ(f, psi.evaluate(x, &g, nullptr));
    for (int d = 0; d < 3; ++d) {
      const Vec3 up = x + e * Vec3::Unit(d), down = x - e * Vec3::Unit(d);
      EXPECT_NEAR(g[d], (psi.value(up) - psi.value(down)) / (2 * e), 1e-7);
      EXPECT_LT((H.col(d) - (psi.gradient(up) - psi.gradient(down)) / (2 * e)).norm(), 2e-5 * (1 + H.norm()));
    }
  }
  // Across faces of cells, on and off the surface: also where blocks and the band itself end.
  double norm = 0;
  std::size_t beyond = 0;
  for (const Vec3& x : torus_cloud(300, 12).points) norm = std::max(norm, psi.hessian(x).norm());
  const LatticeBlocks& blocks = psi.band(psi.n_levels() - 1).blocks;
  const Vec3 origin = psi.coarsest().lattice.origin;
  for (int b = 0; b < blocks.size(); b += 7)
    for (int axis = 0; axis < 3; ++axis)
      for (int face = 0; face <= 8; face += 4) {
        Vec3 xi = (blocks.first_node(b).cast<double>() + Vec3(2.3, 3.7, 1.6)).eval();
        xi[axis] = blocks.first_node(b)[axis] + blocks.shift() + face;
        const Vec3 x = origin + h * xi, step = 1e-12 * Vec3::Unit(axis);
        if (!psi.domain().contains(x + h * Vec3::Unit(axis))) continue;  // at the wall psi has a kink
        beyond += psi.evaluate_level(psi.n_levels() - 1, x, nullptr, nullptr) == 0;
        EXPECT_LT((psi.hessian(x + step) - psi.hessian(x - step)).norm(), 1e-9 * norm);
      }
  EXPECT_GT(beyond, 0u);
}

TEST(MultilevelFit, CutAtASpacingIsTheSumOfTheCoarserLevels) {
  const LevelSet& psi = torus_fit().psi;
  const LevelSet coarse = psi.band_limited(psi.lattice(0).h * 0.9);
  ASSERT_EQ(coarse.n_levels(), 1);
  EXPECT_EQ(psi.band_limited(1e-9).n_levels(), psi.n_levels());
  for (const Vec3& x : torus_cloud(20, 8).points) {
    EXPECT_EQ(coarse.value(x), psi.evaluate_level(0, x, nullptr, nullptr));
    EXPECT_NE(coarse.value(x), psi.value(x));
  }
}

TEST(MultilevelFit, ThreadsDoNotChangeABit) {
  OrientedPointCloud cloud = torus_cloud(8000);
  std::vector<float> first;
  for (const int threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    SsdParams p;
    p.spacing = 0.07;
    p.coarsest_nodes = 10000;
    const SsdFit fit = fit_ssd(cloud, p);
    ASSERT_GE(fit.psi.n_levels(), 2);
    const std::vector<float>& c = fit.psi.band(fit.psi.n_levels() - 1).coefficients;
    if (first.empty()) first = c;
    ASSERT_EQ(first.size(), c.size());
    EXPECT_EQ(std::memcmp(first.data(), c.data(), c.size() * sizeof(float)), 0) << threads << " threads";
  }
}

TEST(MultilevelFit, DenseHalfIsRefinedAndSparseHalfIsNotDented) {
  // The half x > 0 of a sphere has forty times the samples of the other: a lattice for the dense half must not leave
  // marks around each sample of the sparse one.
  OrientedPointCloud cloud;
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  while (cloud.points.size() < 8000) {
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    if (n[0] < 0 && random() % 40 != 0) continue;
    cloud.points.push_back(n), cloud.normals.push_back(n);
  }
  SsdParams p;
  p.coarsest_nodes = 15000;
  const SsdFit fit = fit_ssd(cloud, p);
  ASSERT_GE(fit.psi.n_levels(), 2);
  double dense = 0, sparse = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    double& worst = n[0] > 0 ? dense : sparse;
    worst = std::max(worst, std::abs(fit.psi.value(n)));
  }
  EXPECT_LT(dense, 2e-3 * fit.report.spacing);
  EXPECT_LT(sparse, 0.05 * fit.report.spacing);
}

TEST(MultilevelFit, NoLatticeIsFinerThanTheFinestOfUse) {
  const OrientedPointCloud cloud = torus_cloud(20000);
  SsdParams p;
  p.coarsest_nodes = 8000;
  const SsdFit all = fit_ssd(cloud, p);
  p.finest = 3 * all.report.spacing;
  const SsdFit few = fit_ssd(cloud, p);
  EXPECT_DOUBLE_EQ(few.report.spacing, p.finest);
  EXPECT_LT(few.report.n_nodes, all.report.n_nodes / 4);
  p.coarsest_nodes = 150000;
  const SsdFit full = fit_ssd(cloud, p);
  EXPECT_TRUE(full.report.bands.empty());
  EXPECT_LT(full.report.spacing, p.finest) << "a full lattice may be finer";
  EXPECT_GT(full.report.spacing, all.report.spacing);
  p.finest = all.report.spacing / 2;
  EXPECT_EQ(fit_ssd(cloud, p).report.spacing, all.report.spacing) << "samples show nothing finer";
  p.finest = -1;
  EXPECT_THROW(fit_ssd(cloud, p), std::invalid_argument);
}

TEST(MultilevelFit, ResidualsOfMergedSamplesAreThoseOfTheSamples) {
  OrientedPointCloud cloud = torus_cloud(8000);
  SsdParams p;
  p.spacing = .08;
  const double before = fit_ssd(cloud, p).report.rms_value;
  cloud.counts.assign(8000, 5);
  cloud.spreads.assign(8000, .01);
  EXPECT_NEAR(fit_ssd(cloud, p).report.rms_value, std::hypot(before, .01), 1e-5);
}

TEST(MultilevelFit, FinestLatticeTakesSamplesAtTheirWordWithOrWithoutCoarserOnes) {
  const OrientedPointCloud cloud = torus_cloud(1500);
  SsdParams p;
  p.coarsest_nodes = 14000;
  const SsdReport banded = fit_ssd(cloud, p).report;
  p.coarsest_nodes = 1000000;
  const SsdReport lone = fit_ssd(cloud, p).report;
  ASSERT_EQ(banded.bands.size(), 1u);
  ASSERT_TRUE(lone.bands.empty());
  ASSERT_EQ(lone.spacing, banded.spacing);
  // Weighed as on lattices that finer ones follow, the lone one misses its samples 2.5 times as far as the band does.
  EXPECT_LT(lone.rms_value, 1.9 * banded.rms_value);
}
