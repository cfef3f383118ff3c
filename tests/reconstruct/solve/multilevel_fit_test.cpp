// The multilevel fit: merged samples, cross-level Gram terms, the operator of a band, and the sum of levels.

#include "reconstruct/solve/multilevel_fit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <numbers>

#include "reconstruct/basis/cross_gram.h"
#include "reconstruct/solve/fit_ssd.h"
#include "reconstruct/solve/ssd_band.h"
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

// A coarse level with rough coefficients, and samples of a small sphere on the lattice of half its spacing.
struct SmallProblem {
  LmeTables tables{LmePrior{}};
  Lattice coarse{{-1, -1, -1}, 0.1, {21, 21, 21}}, fine{{-1, -1, -1}, 0.05, {41, 41, 41}};
  double kappa = 0.03;
  std::vector<SsdSample> samples;
  std::mt19937_64 random{7};

  SmallProblem() {
    std::normal_distribution<double> normal;
    std::vector<SsdSample> all(300);
    for (SsdSample& s : all) {
      s.normal = Vec3(normal(random), normal(random), normal(random)).normalized();
      s.xi = (0.3 * s.normal - fine.origin) / fine.h;
      s.w_value = 0.7, s.w_gradient = 0.9, s.value = 0.1;
    }
    samples = merge_samples(all, 0.5);
  }
  LevelSet psi() {
    std::normal_distribution<double> normal;
    std::vector<double> c(coarse.size());
    for (double& v : c) v = 0.1 * normal(random);
    return LevelSet(LmePrior{}, {coarse, c});
  }
};

// (block, node in block) of every node that a lattice has.
template <class F>
void for_each_node(const LatticeBlocks& blocks, F&& f) {
  for (int b = 0; b < blocks.size(); ++b)
    for (int i = 0; i < LatticeBlocks::kNodes; ++i) {
      const Eigen::Vector3i node = blocks.first_node(b) + Eigen::Vector3i(i % 8, i / 8 % 8, i / 64);
      if ((node.array() >= 0).all() && (node.array() < blocks.lattice().n.array()).all()) {
        f(static_cast<std::size_t>(b) * LatticeBlocks::kNodes + i, node);
      }
    }
}

}  // namespace

TEST(MergeSamples, MeanOfASphereKnowsItsDistance) {
  // Samples of a cap that a cube holds: their mean lies inside the sphere by a quarter of the cap's height, and its
  // value says so to third order.
  std::vector<SsdSample> cap;
  const double radius = 5;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.04 * std::sqrt((i + 0.5) / 400), a = 2.399963 * i;
    const Vec3 n(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
    cap.push_back({Vec3(10.25, 10.25, 10.25 - radius) + radius * n, n, 1, 1, 0});
  }
  const std::vector<SsdSample> mean = merge_samples(cap, 0.5);
  ASSERT_EQ(mean.size(), 1u);
  const double distance = (mean[0].xi - Vec3(10.25, 10.25, 10.25 - radius)).norm() - radius;
  EXPECT_LT(distance, -1e-3);
  EXPECT_NEAR(mean[0].value, distance, 1e-3 * std::abs(distance));
  EXPECT_EQ(mean[0].w_value, 400);
}

TEST(MergeSamples, KeepsWeightsAndOrdersByBlock) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 40);
  std::vector<SsdSample> samples(5000);
  for (SsdSample& s : samples) s = {Vec3(unit(random), unit(random), unit(random)), Vec3::UnitX(), 2, 1, 0};
  const std::vector<SsdSample> merged = merge_samples(samples, 1);
  EXPECT_LT(merged.size(), samples.size());
  double weight = 0;
  std::vector<std::array<int, 3>> blocks;
  for (const SsdSample& s : merged) {
    weight += s.w_value;
    const Eigen::Vector3i b = (s.xi / 8).array().floor().cast<int>();
    if (blocks.empty() || blocks.back() != std::array{b[2], b[1], b[0]}) blocks.push_back({b[2], b[1], b[0]});
  }
  EXPECT_NEAR(weight, 10000, 1e-9);
  EXPECT_TRUE(std::is_sorted(blocks.begin(), blocks.end()));  // each block once
}

TEST(ResolvedSamples, LeavesSparseCellsToTheCoarserLevels) {
  std::vector<SsdSample> samples;
  const auto add = [&](const Vec3& xi, double area) { samples.push_back({xi, Vec3::UnitX(), area, area, 0}); };
  add({1.2, 1.2, 1.2}, 1), add({1.7, 1.2, 1.2}, 9);    // one of the cell's samples is dense enough: both stay
  add({3.2, 1.2, 1.2}, 9), add({20.5, 3.5, 3.5}, 30);  // alone
  const std::vector<SsdSample> kept = resolved_samples(samples, 4);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[1].w_value, 9);
}

TEST(ResolvedSamples, ThoseOfAScanLineAreResolvedWhenItsGapIs) {
  std::vector<SsdSample> line;
  for (int i = 0; i < 16; ++i)
    line.push_back({{1.25 + .5 * (i % 2), 1.2, 1.2}, Vec3::UnitX(), .5, .5, 0, i < 8 ? 3. : 5.});
  EXPECT_EQ(resolved_samples(line, 4).size(), 16u);
  for (SsdSample& s : line) s.gap2 = 5;
  EXPECT_TRUE(resolved_samples(line, 4).empty());
}

TEST(CrossGram, OnOneLatticeIsTheGramMatrix) {
  for (const int support : {2, 3, 4}) {
    LmePrior prior;
    prior.support = support;
    const LmeTables tables(prior);
    const AxisGram axis = axis_gram(tables, 6 * support);
    const CrossGram cross(tables, 0);
    const int i = 3 * support;
    for (int d = -cross.reach(); d <= cross.reach(); ++d) {
      EXPECT_NEAR(cross.m(d), axis.m(i, i + d), 1e-13);
      EXPECT_NEAR(cross.s(d), axis.s(i, i + d), 1e-12);
      EXPECT_NEAR(cross.b(d), axis.b(i, i + d), 1e-11);
    }
  }
}

TEST(CrossGram, AgreesWithSumsOverPoints) {
  const LmeTables tables{LmePrior{}};
  for (const int k : {1, 2, 3}) {
    const CrossGram cross(tables, k);
    const int ratio = 1 << k;
    for (const int d : {0, 1, 3, ratio + 1, -2 * ratio, cross.reach()}) {
      double m = 0, s = 0, b = 0;  // trapezoids: both functions and their derivatives vanish at their ends
      const int points = 400;      // a fine cell
      for (int q = -3 * ratio * points; q <= 3 * ratio * points; ++q) {
        const double x = static_cast<double>(q) / points;
        if (std::abs(x - d) >= 3) continue;
        LmeBasis1d fine, coarse;
        tables.evaluate<true>(30, 15 + x - d - std::floor(x - d) + 0.0, fine);
        const int lane_fine = 15 - static_cast<int>(std::floor(x - d)) - fine.first;
        tables.evaluate<true>(30, 15 + x / ratio, coarse);
        const int lane = 15 - coarse.first;
        if (lane < 0 || lane > 7 || lane_fine < 0 || lane_fine > 7) continue;
        m += fine.N[lane_fine] * coarse.N[lane] / points;
        s += fine.dN[lane_fine] * coarse.dN[lane] / ratio / points;
        b += fine.ddN[lane_fine] * coarse.ddN[lane] / (ratio * ratio) / points;
      }
      EXPECT_NEAR(cross.m(d), m, 1e-6) << k << ' ' << d;
      EXPECT_NEAR(cross.s(d), s, 1e-5) << k << ' ' << d;
      EXPECT_NEAR(cross.b(d), b, 1e-4) << k << ' ' << d;
    }
  }
}

TEST(CrossGram, EnergyOfABlockIsTheSumOverAllPairs) {
  const LmeTables tables{LmePrior{}};
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const int k : {1, 2, 4}) {
    const CrossGram g(tables, k);
    const Eigen::Vector3i first(14, -2, 30), begin = g.window_begin(first);
    const int n = g.window_size();
    std::vector<float> C(n * n * n), out(LatticeBlocks::kNodes, 0.f);
    for (float& c : C) c = static_cast<float>(normal(random));
    g.add_energy(first, C.data(), out.data());
    for (const Eigen::Vector3i& in : {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(7, 2, 5), Eigen::Vector3i(3, 7, 7)}) {
      double sum = 0;
      for (int i = 0; i < n * n * n; ++i) {
        const Eigen::Vector3i J = begin + Eigen::Vector3i(i % n, i / n % n, i / n / n);
        const Eigen::Vector3i d = first + in - (1 << k) * J;
        const double mx = g.m(d[0]), my = g.m(d[1]), mz = g.m(d[2]), sx = g.s(d[0]), sy = g.s(d[1]), sz = g.s(d[2]);
        sum += C[i] * (g.b(d[0]) * my * mz + mx * g.b(d[1]) * mz + mx * my * g.b(d[2]) +
                       2 * (sx * sy * mz + sx * my * sz + mx * sy * sz));
      }
      EXPECT_NEAR(out[in[0] + 8 * (in[1] + 8 * in[2])], sum, 1e-5);
    }
    // No coarse node outside the window meets the block.
    EXPECT_GT(first[0] - (begin[0] - 1) * (1 << k), g.reach());
    EXPECT_GT((begin[0] + n) * (1 << k) - (first[0] + 7), g.reach());
  }
}

TEST(SsdBand, IsTheOperatorOfTheFullLattice) {
  SmallProblem s;
  const SsdBand band(s.tables, s.fine, s.kappa, s.samples);
  const SsdOperator full(s.tables, s.fine.n, s.kappa, s.samples);
  EXPECT_GT(band.n_active(), 2000u);
  EXPECT_LT(band.n_active(), band.size());
  std::vector<float> p(band.size(), 0.f), y(band.size());
  std::vector<double> c(full.size() + SsdOperator::kPad, 0.0), Ac(c), work, D(c);
  std::normal_distribution<double> normal;
  for_each_node(band.blocks(), [&](std::size_t a, const Eigen::Vector3i& node) {
    if (band.inverse_diagonal()[a] == 0) return;
    p[a] = static_cast<float>(normal(s.random));
    c[s.fine.index(node[0], node[1], node[2])] = p[a];
  });
  band.apply(p.data(), y.data());
  full.apply(c.data(), Ac.data(), work);
  full.diagonal(D.data());
  std::size_t compared = 0;
  for_each_node(band.blocks(), [&](std::size_t a, const Eigen::Vector3i& node) {
    if (band.inverse_diagonal()[a] == 0) return;
    const std::ptrdiff_t at = s.fine.index(node[0], node[1], node[2]);
    EXPECT_NEAR(y[a], Ac[at], 2e-6 * (1 + std::abs(Ac[at])));
    EXPECT_NEAR(1 / band.inverse_diagonal()[a], D[at], 1e-5 * D[at]);
    ++compared;
  });
  EXPECT_EQ(compared, band.n_active());
}

TEST(SsdBand, ResidualIsTheDerivativeOfTheFunctional) {
  // d/de of the functional at f + e N_a, e = 0, with the energy integrated over points of the fine cells.
  SmallProblem s;
  const LevelSet psi = s.psi();
  const SsdBand band(s.tables, s.fine, s.kappa, s.samples);
  std::vector<float> r;
  band.residual(psi, r);
  int compared = 0;
  for_each_node(band.blocks(), [&](std::size_t a, const Eigen::Vector3i& node) {
    if (band.inverse_diagonal()[a] == 0 || a % 97 != 0) return;
    std::vector<double> unit(s.fine.size(), 0.0);
    unit[s.fine.index(node[0], node[1], node[2])] = 1;
    const LevelSet N(LmePrior{}, {s.fine, unit});
    double expected = 0;
    for (const SsdSample& sample : s.samples) {
      const Vec3 x = s.fine.origin + s.fine.h * sample.xi;
      expected += sample.w_value * N.value(x) * (sample.value - psi.value(x) / s.fine.h) +
                  sample.w_gradient * s.fine.h * N.gradient(x).dot(sample.normal - psi.gradient(x));
    }
    double energy = 0;
    const double gauss[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight[3] = {5. / 18, 8. / 18, 5. / 18};
    for (int cell = 0; cell < 216; ++cell)
      for (int q = 0; q < 27; ++q) {
        const Vec3 t = 0.5 * Vec3(gauss[q % 3], gauss[q / 3 % 3], gauss[q / 9]) + Vec3::Constant(0.5);
        const Vec3 xi = node.cast<double>() + Vec3(cell % 6, cell / 6 % 6, cell / 36) - Vec3::Constant(3) + t;
        const Vec3 x = s.fine.origin + s.fine.h * xi;
        energy += weight[q % 3] * weight[q / 3 % 3] * weight[q / 9] *
                  (N.hessian(x).array() * psi.hessian(x).array()).sum() * std::pow(s.fine.h, 3);
      }
    expected -= s.kappa * energy;
    EXPECT_NEAR(r[a], expected, 2e-3 * (1 + std::abs(expected))) << node.transpose();  // 3 Gauss points a cell
    ++compared;
  });
  EXPECT_GT(compared, 20);
}

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
