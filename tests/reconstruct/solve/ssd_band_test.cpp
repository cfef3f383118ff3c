// Gram terms between levels, and the operator of a band.

#include "reconstruct/solve/ssd_band.h"

#include <gtest/gtest.h>

#include <random>

#include "reconstruct/basis/cross_gram.h"
#include "reconstruct/solve/multilevel_fit.h"
#include "tests/support/clouds.h"

using namespace umtet;
using namespace umtet::test;

namespace {

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
