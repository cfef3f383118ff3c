// The fit: what it must reproduce, that its solvers agree, and how close it comes to a known surface.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "reconstruct/cloud/neighbours/morton_order.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/solve/resolution.h"
#include "reconstruct/solve/ssd_assembled.h"
#include "tests/support/fit_scattered.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

using namespace umtet;
using namespace umtet::test;

namespace {

SsdParams params_with(double spacing) {
  SsdParams p;
  p.spacing = spacing;
  p.solver = SsdSolver::Full;
  return p;
}

// Largest |psi_a - psi_b| over places near the torus.
double difference(const LevelSet& a, const LevelSet& b) {
  double worst = 0;
  for (const Vec3& x : torus_cloud(500, 9).points)
    worst = std::max(worst, std::abs(a.value(1.02 * x) - b.value(1.02 * x)));
  return worst;
}

}  // namespace

TEST(FitSsd, PlanarCloudIsReproducedExactly) {
  // The plane's distance has no Hessian: it is in the space and makes every term zero.
  const Vec3 normal = Vec3(1, 2, -0.5).normalized();
  for (const SsdWeights weights : {SsdWeights::Area, SsdWeights::Paper}) {
    SsdParams p = params_with(0.2);
    p.weights = weights;
    p.tolerance = 1e-10;
    const SsdFit fit = fit_ssd(plane_cloud(20, normal), p);
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(0.3, -0.1, 0.2), Vec3(-0.2, 0.05, 0.1)}) {
      EXPECT_NEAR(fit.psi.value(x), normal.dot(x), 1e-6);
      EXPECT_LT((fit.psi.gradient(x) - normal).norm(), 1e-5);
    }
  }
}

TEST(FitSsd, TorusLiesWithinHalfAThousandthOfTheSpacing) {
  const double h = 0.076;
  const SsdFit fit = fit_ssd(torus_cloud(20000), params_with(h));
  double mean = 0, normal2 = 0;
  const OrientedPointCloud truth = torus_cloud(2000, 77);
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    Vec3 g;
    const double f = fit.psi.evaluate(truth.points[i], &g, nullptr);
    mean += std::abs(f) / g.norm();
    normal2 += (g.normalized() - truth.normals[i]).squaredNorm();
  }
  const double n = static_cast<double>(truth.points.size());
  EXPECT_LT(mean / n, 5e-4 * h);
  EXPECT_LT(std::sqrt(normal2 / n), 4e-3);
  EXPECT_LE(fit.report.iterations, 20);
}

TEST(Resolution, FollowsSamplesMeshAndNoise) {
  EXPECT_DOUBLE_EQ(choose_resolution(1, 10, 0).spacing, 1.25);
  EXPECT_DOUBLE_EQ(choose_resolution(1, 1.15, 0).spacing, 1.15);  // as fine as the mesh
  EXPECT_DOUBLE_EQ(choose_resolution(1, .1, 0).spacing, 1.25 / 1.2);
  EXPECT_DOUBLE_EQ(choose_resolution(1, 10, .6).spacing, 1.8);
  EXPECT_DOUBLE_EQ(choose_resolution(1, 10, .6, 2).spacing, .9);
  const Resolution clean = choose_resolution(1, 10, 0), noisy = choose_resolution(1, 10, .6),
                   smooth = choose_resolution(1, 10, .6, 1, 3);
  EXPECT_LT(clean.finest_smoothing, clean.smoothing);
  EXPECT_GT(noisy.finest_smoothing, clean.finest_smoothing);
  EXPECT_NEAR(noisy.smoothing - noisy.finest_smoothing, clean.smoothing - clean.finest_smoothing, 1e-15);
  EXPECT_DOUBLE_EQ(smooth.smoothing, 3 * noisy.smoothing);
  EXPECT_DOUBLE_EQ(smooth.finest_smoothing, 3 * noisy.finest_smoothing);
  EXPECT_EQ(noisy.reason.find("3 times the noise of 0.6"), 0U);
}

// No sample speaks outside a sharp edge: with c = .001 on all lattices there are bodies beside the edges of four of
// these.
TEST(FitSsd, NothingIsInsideBesideASharpEdge) {
  const std::vector<std::pair<Vec3, double>> boxes = {{{1, 1, 1}, .075},  {{1, 1, 1}, .12},   {{1, .6, .3}, .08},
                                                      {{2, 1, .2}, .019}, {{2, 1, .2}, .015}, {{2, 1, .2}, .025}};
  for (const auto& [size, spacing] : boxes) {
    SCOPED_TRACE(fmt::format("box of {} x {} x {}, spacing {}", size.x(), size.y(), size.z(), spacing));
    const LevelSet psi = fit_ssd(box_cloud(size, spacing), {}).psi;
    double least = 1;  // of psi over the distance from the corner's three edges
    constexpr int n = 10;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 along = Vec3::Unit(axis), a = Vec3::Unit((axis + 1) % 3), b = Vec3::Unit((axis + 2) % 3);
      for (int i = -n; i <= n; ++i) {
        for (int j = -n; j <= n; ++j) {
          const double da = 2.5 * spacing * i / n, db = 2.5 * spacing * j / n;
          const double off = std::hypot(std::max(da, 0.), std::max(db, 0.));
          if (off < .75 * spacing) continue;
          for (int k = 0; k <= 40; ++k)
            least = std::min(least, psi.value(size + da * a + db * b - k * size[axis] / 40 * along) / off);
        }
      }
    }
    EXPECT_GT(least, 0);
  }
}

TEST(FitSsd, MultigridAgreesWithTheAssembledSolve) {
  const OrientedPointCloud cloud = torus_cloud(400);
  for (const LmePrior& prior : {LmePrior{}, LmePrior::paper()}) {
    SsdParams p = params_with(0.5);  // 1331 nodes, the least of two levels: 1331 entries a row fill up at once
    p.padding = 2;
    p.prior = prior;
    p.tolerance = 1e-11;
    const SsdFit iterative = fit_ssd(cloud, p);
    ASSERT_EQ(iterative.report.n_nodes, 1331u);
    p.solver = SsdSolver::Assembled;
    const SsdFit direct = fit_ssd(cloud, p);
    EXPECT_LT(difference(iterative.psi, direct.psi), 1e-7 * p.spacing);
    EXPECT_NEAR(iterative.report.energy_hessian / direct.report.energy_hessian, 1, 1e-6);
  }
}

TEST(FitSsd, ScatteredNodesOnALatticeGiveTheLatticeFit) {
  const OrientedPointCloud cloud = torus_cloud(400);
  SsdParams p = params_with(0.8);
  p.weights = SsdWeights::Paper;
  p.alpha = 0.02;
  p.padding = 2;
  p.prior.support = 2;  // 64 functions at a point instead of 216; lme_test compares those of every support
  p.tolerance = 1e-10;
  const SsdFit lattice_fit = fit_ssd(cloud, p);
  const Lattice& L = lattice_fit.psi.coarsest().lattice;
  std::vector<Vec3> nodes;
  for (int k = 0; k < L.n[2]; ++k)
    for (int j = 0; j < L.n[1]; ++j)
      for (int i = 0; i < L.n[0]; ++i) nodes.push_back(L.origin + L.h * Vec3(i, j, k));
  std::vector<SsdSample> samples(cloud.points.size());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = {cloud.points[i], cloud.normals[i], 1, 1};
  const LmeScattered basis(nodes, p.prior, L.h);
  const std::vector<double> f = fit_scattered(basis, samples, p.alpha, L.h);
  double worst = 0;
  for (const Vec3& x : torus_cloud(100, 5).points) {
    const LmeValues v = basis.evaluate(1.03 * x);
    double value = 0;
    for (std::size_t a = 0; a < v.node.size(); ++a) value += v.N[a] * f[v.node[a]];
    worst = std::max(worst, std::abs(value - lattice_fit.psi.value(1.03 * x)));
  }
  EXPECT_LT(worst, 2e-3 * L.h);  // 2 Gauss points a cell and axis here, 8 there
  EXPECT_GT(worst, 0);
}

TEST(FitSsd, AreaWeightsDoNotKnowUnits) {
  const OrientedPointCloud cloud = torus_cloud(1000);
  const SsdFit fit = fit_ssd(cloud, params_with(0.3));
  for (const double scale : {1e-3, 1e3}) {
    OrientedPointCloud scaled = cloud;
    for (Vec3& x : scaled.points) x *= scale;
    const SsdFit other = fit_ssd(scaled, params_with(0.3 * scale));
    for (const Vec3& x : torus_cloud(50, 3).points) {
      EXPECT_NEAR(other.psi.value(1.05 * scale * x) / scale, fit.psi.value(1.05 * x), 1e-9);
    }
    EXPECT_NEAR(other.report.energy_normal / (scale * scale) / fit.report.energy_normal, 1, 1e-6);
  }
}

TEST(FitSsd, ThreadsDoNotChangeABit) {
  OrientedPointCloud cloud = torus_cloud(8000);
  for (std::vector<Vec3>* vectors : {&cloud.points, &cloud.normals})  // upright: four slabs of samples, not two
    for (Vec3& v : *vectors) std::swap(v[0], v[2]);
  std::vector<double> first;
  for (const int threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    SsdParams p = params_with(0.09);
    p.tolerance = 1e-2;  // every kind of step is taken in the first iterations
    const SsdFit fit = fit_ssd(cloud, p);
    const auto& [lattice, c] = fit.psi.coarsest();
    ASSERT_GT(lattice.n[2], 36);           // slabs have 12 layers: two of each parity
    ASSERT_GT(lattice.size(), 2 * 16384);  // three of the chunks that sums are made of
    if (first.empty()) first = c;
    ASSERT_EQ(first.size(), c.size());
    EXPECT_EQ(std::memcmp(first.data(), c.data(), c.size() * sizeof(double)), 0) << threads << " threads";
  }
}

TEST(FitSsd, RefusesBrokenInputAndSaysAllOfIt) {
  SsdParams p;
  p.smoothing = -1;
  p.max_iterations = 0;
  p.prior.gamma = -1;
  EXPECT_EQ(problems(p).size(), 3u);
  EXPECT_THROW(fit_ssd(torus_cloud(100), p), std::invalid_argument);
  EXPECT_THROW(fit_ssd(torus_cloud(5), SsdParams{}), std::invalid_argument);
  EXPECT_THROW(fit_ssd(torus_cloud(100), params_with(1e-7)), std::length_error);
  OrientedPointCloud needle = torus_cloud(100);  // 1e8 nodes in a row that no halving makes small
  for (Vec3& x : needle.points) x[1] *= 1e-5, x[2] *= 1e-5;
  EXPECT_THROW(fit_ssd(needle, params_with(2e-9)), std::length_error);
  EXPECT_THROW(fit_ssd(torus_cloud(100), params_with(1e50)), SolveError);
  SsdParams assembled = params_with(0.1);
  assembled.solver = SsdSolver::Assembled;
  EXPECT_THROW(fit_ssd(torus_cloud(1000), assembled), SolveError);
  SsdParams hasty = params_with(0.2);
  hasty.max_iterations = 1;
  EXPECT_THROW(fit_ssd(torus_cloud(1000), hasty), SolveError);
}

TEST(FitSsd, ReportsNormalsThatCannotBeRight) {
  OrientedPointCloud cloud = torus_cloud(1000);
  const SsdReport good = fit_ssd(cloud, params_with(0.3)).report;
  EXPECT_EQ(good.n_opposed_normals, 0u);
  EXPECT_GT(good.least_wall_value, 0);
  OrientedPointCloud inward = cloud;
  for (Vec3& n : inward.normals) n = -n;
  EXPECT_LT(fit_ssd(inward, params_with(0.3)).report.least_wall_value, 0);
  for (std::size_t i = 0; i < cloud.normals.size(); i += 5) cloud.normals[i] *= -1;
  const SsdReport mixed = fit_ssd(cloud, params_with(0.3)).report;
  EXPECT_NEAR(static_cast<double>(mixed.n_opposed_normals), 200, 20);
}

TEST(FitSsd, ScanLinesAreFittedAsFinelyAsTheirGapsWhateverTheirDensity) {
  constexpr double kGap = .07;
  OrientedPointCloud surface;
  test::add_sphere(surface, Vec3::Zero(), 1, 997);
  for (const double ratio : {10., 30.}) {
    OrientedPointCloud lines = test::ball_in_lines(kGap, ratio);
    sort_in_space(lines);
    const SsdFit fit = fit_ssd(lines);
    EXPECT_GT(fit.report.spacing, .25 * kGap) << ratio;
    EXPECT_LT(fit.report.spacing, 1.25 * kGap) << ratio;
    for (const Vec3& x : surface.points) {
      Vec3 g;
      EXPECT_LT(std::abs(fit.psi.evaluate(x, &g, nullptr)), .01 * kGap) << ratio;
      EXPECT_GT(g.normalized().dot(x), std::cos(1 * std::numbers::pi / 180)) << ratio;
    }
  }
}

TEST(FitSsd, StopsWhenTold) {
  int calls = 0;
  EXPECT_THROW(fit_ssd(torus_cloud(500), params_with(0.4), {.cancelled = [&] { return ++calls >= 4; }}), Cancelled);
  EXPECT_EQ(calls, 4);
}

TEST(FitSsd, NoisyCloudIsFittedWithItsNoiseEstimated) {
  // Eq. (9), noise of 0.5 % of the diagonal along each axis and 6 degrees.
  OrientedPointCloud cloud = sampled(umtet::testing::equation_9(), 50000, 5);
  const double diagonal = box_diagonal(cloud.points), tilt = std::tan(6 * std::numbers::pi / 180) / std::numbers::sqrt2;
  cloud = with_noise(std::move(cloud), 0.005 * diagonal);
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  for (Vec3& n : cloud.normals) n = (n + tilt * Vec3(gauss(random), gauss(random), gauss(random))).normalized();
  SsdParams p;
  p.noise = noise_along_normals(cloud.points);
  EXPECT_NEAR(p.noise, 0.005 * diagonal, 0.05 * 0.005 * diagonal);
  const LevelSet psi = fit_ssd(cloud, p).psi;
  const std::vector<Vec3> truth = sampled(umtet::testing::equation_9(), 5000, 99).points;
  double sum = 0;
  for (const Vec3& start : truth) {
    Vec3 x = start, g;
    for (int it = 0; it < 6; ++it) {
      const double f = psi.evaluate(x, &g, nullptr);
      x -= f / g.squaredNorm() * g;
    }
    sum += (x - start).norm();
  }
  EXPECT_LT(sum / static_cast<double>(truth.size()), 3.5e-4 * diagonal);
}
