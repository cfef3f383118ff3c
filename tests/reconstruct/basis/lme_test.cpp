// Max-ent functions: the lattice ones, their tables, and the scattered reference.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reconstruct/basis/lme_lattice.h"
#include "tests/support/lme_scattered.h"

using namespace umtet;

namespace {

std::vector<LmePrior> priors() {
  return {LmePrior{},
          {LmePrior::Kind::CompactC2, 0.8, 4, 1e-4},
          {LmePrior::Kind::CompactC2, 1.6, 2, 1e-4},
          LmePrior::paper()};
}

// Points of an axis of n nodes: hull cells, interior cells, nodes.
std::vector<double> places(int n) {
  std::vector<double> x{0.0, 0.3, 1.0, 1.7, n - 1.0, n - 1.4};
  for (int i = 0; i < 40; ++i) x.push_back((n - 1) * (0.5 + 0.499 * std::sin(3.7 * i)));
  return x;
}

std::vector<Vec3> cube_nodes(int n, double h) {
  std::vector<Vec3> nodes;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) nodes.push_back(h * Vec3(i, j, k));
  return nodes;
}

}  // namespace

TEST(LmeBasis, IsNonNegativeSumsToOneAndReproducesAffineFunctions) {
  for (const LmePrior& prior : priors()) {
    const LmeTables tables(prior);
    for (const int n : {tables.width(), 9, 30}) {
      for (const double x : places(n)) {
        LmeBasis1d B;
        tables.evaluate<true>(n, x, B);
        double sum = 0, dsum = 0, ddsum = 0, first = 0, dfirst = 0, ddfirst = 0;
        ASSERT_GE(B.first, 0);
        ASSERT_LE(B.first + tables.width(), n);
        for (int a = 0; a < tables.width(); ++a) {
          const double node = B.first + a - x;
          EXPECT_GE(B.N[a], -1e-15);
          sum += B.N[a], dsum += B.dN[a], ddsum += B.ddN[a];
          first += node * B.N[a], dfirst += node * B.dN[a], ddfirst += node * B.ddN[a];
        }
        EXPECT_NEAR(sum, 1, 1e-13);
        EXPECT_NEAR(dsum, 0, 1e-9);
        EXPECT_NEAR(ddsum, 0, 1e-6);
        EXPECT_NEAR(first, 0, 1e-12) << "x " << x << " of " << n;
        EXPECT_NEAR(dfirst, 1, 1e-9);
        EXPECT_NEAR(ddfirst, 0, 1e-6);
      }
    }
  }
}

TEST(LmeBasis, DerivativesAreThoseOfTheFunctions) {
  for (const LmePrior& prior : priors()) {
    const int n = 16;
    const double e = 1e-5;
    for (const double x : {0.4, 1.55, 5.21, 7.77, 14.3}) {
      const LmeBasis1d B = evaluate_lme_1d(prior, n, x), P = evaluate_lme_1d(prior, n, x + e),
                       M = evaluate_lme_1d(prior, n, x - e);
      for (int a = 0; a < 2 * half_width(prior); ++a) {
        EXPECT_NEAR(B.dN[a], (P.N[a] - M.N[a]) / (2 * e), 1e-9);
        EXPECT_NEAR(B.ddN[a], (P.dN[a] - M.dN[a]) / (2 * e), 1e-8);
      }
    }
  }
}

TEST(LmeBasis, CompactPriorIsC2AcrossCells) {
  for (const int support : {2, 3, 4}) {
    const LmeTables tables({LmePrior::Kind::CompactC2, 1.2, support, 1e-4});
    const int n = 20;
    for (const double x : {1.0, 3.0, 8.0, 18.0}) {
      LmeBasis1d L, R;
      tables.evaluate<true>(n, x - 1e-9, L);
      tables.evaluate<true>(n, x + 1e-9, R);
      for (int node = 0; node < n; ++node) {
        const auto at = [&](const LmeBasis1d& B, const double* v) {
          return node >= B.first && node < B.first + tables.width() ? v[node - B.first] : 0.0;
        };
        EXPECT_NEAR(at(L, L.N), at(R, R.N), 1e-8);
        EXPECT_NEAR(at(L, L.dN), at(R, R.dN), 1e-7);
        EXPECT_NEAR(at(L, L.ddN), at(R, R.ddN), 1e-6);
      }
    }
  }
}

TEST(LmeBasis, PaperPriorJumpsAtItsCut) {
  // Why it is not the default: the second derivative of a Gaussian cut at 1e-4 jumps by more than 1e-3.
  const LmePrior prior = LmePrior::paper();
  const double x = 10 + radius(prior) - 2;  // node 8 leaves the support here
  const LmeBasis1d L = evaluate_lme_1d(prior, 20, x - 1e-9), R = evaluate_lme_1d(prior, 20, x + 1e-9);
  double jump = 0;
  for (int a = 0; a < 6; ++a) jump = std::max(jump, std::abs(L.ddN[a] - R.ddN[a]));
  EXPECT_GT(jump, 1e-3);
}

TEST(LmeTables, AreTheFunctions) {
  for (const LmePrior& prior : priors()) {
    const LmeTables tables(prior);
    for (const int n : {tables.width(), 11, 40}) {
      for (const double x : places(n)) {
        if (x < 0.01 || x > n - 1.01) continue;  // lambda has a pole at the ends
        LmeBasis1d T;
        tables.evaluate<true>(n, x, T);
        const LmeBasis1d B = evaluate_lme_1d(prior, n, x);
        ASSERT_EQ(T.first, B.first);
        for (int a = 0; a < tables.width(); ++a) {
          EXPECT_NEAR(T.N[a], B.N[a], 1e-13) << "gamma " << prior.gamma << " x " << x;
          EXPECT_NEAR(T.dN[a], B.dN[a], 1e-10);
          EXPECT_NEAR(T.ddN[a], B.ddN[a], 1e-6);
        }
      }
    }
  }
}

TEST(LmeScattered, EqualsTheLatticeOnLatticeNodes) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const double h = 0.37;
  const int n = 8;
  // A Gaussian is compared where its cut, a sphere here and a box there, no longer matters.
  for (const LmePrior& prior : {LmePrior{}, LmePrior{LmePrior::Kind::Gaussian, 2.0, 3, 1.3e-14}}) {
    const LmeScattered scattered(cube_nodes(n, h), prior, h);
    for (int trial = 0; trial < 30; ++trial) {
      const Vec3 xi = Vec3(unit(random), unit(random), unit(random)) * (n - 1.2) + Vec3::Constant(0.1);
      const LmeValues v = scattered.evaluate(h * xi);
      ASSERT_TRUE(v.converged);
      LmeBasis1d B[3];
      for (int d = 0; d < 3; ++d) B[d] = evaluate_lme_1d(prior, n, xi[d]);
      for (std::size_t a = 0; a < v.node.size(); ++a) {
        const int at[3] = {v.node[a] % n, v.node[a] / n % n, v.node[a] / (n * n)};
        double N[3], dN[3], ddN[3];
        for (int d = 0; d < 3; ++d) {
          const int lane = at[d] - B[d].first;
          const bool in = lane >= 0 && lane < 2 * half_width(prior);
          N[d] = in ? B[d].N[lane] : 0, dN[d] = in ? B[d].dN[lane] : 0, ddN[d] = in ? B[d].ddN[lane] : 0;
        }
        EXPECT_NEAR(v.N[a], N[0] * N[1] * N[2], 1e-10);
        EXPECT_NEAR(v.grad[a][1] * h, N[0] * dN[1] * N[2], 1e-10);
        EXPECT_NEAR(v.hess[a](0, 0) * h * h, ddN[0] * N[1] * N[2], 1e-10);
        EXPECT_NEAR(v.hess[a](0, 2) * h * h, dN[0] * N[1] * dN[2], 1e-10);
      }
    }
  }
}

TEST(LmeScattered, DerivativesOnRandomNodesPassFiniteDifferences) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-0.25, 0.25);
  std::vector<Vec3> nodes = cube_nodes(7, 1.0);
  for (Vec3& p : nodes) p += Vec3(unit(random), unit(random), unit(random));
  for (const LmePrior& prior :
       {LmePrior{LmePrior::Kind::CompactC2, 0.9, 3, 1e-4}, LmePrior{LmePrior::Kind::Gaussian, 1.6, 3, 1e-12}}) {
    const LmeScattered basis(nodes, prior, 1.0);
    const Vec3 x(3.1, 2.83, 3.4);
    const LmeValues v = basis.evaluate(x);
    ASSERT_TRUE(v.converged);
    Vec3 reproduced = Vec3::Zero();
    double sum = 0;
    for (std::size_t a = 0; a < v.node.size(); ++a) sum += v.N[a], reproduced += v.N[a] * nodes[v.node[a]];
    EXPECT_NEAR(sum, 1, 1e-13);
    EXPECT_LT((reproduced - x).norm(), 1e-12);
    const double e = 1e-5;
    for (int d = 0; d < 3; ++d) {
      const LmeValues p = basis.evaluate(x + e * Vec3::Unit(d)), m = basis.evaluate(x - e * Vec3::Unit(d));
      ASSERT_EQ(p.node, v.node);
      ASSERT_EQ(m.node, v.node);
      for (std::size_t a = 0; a < v.node.size(); ++a) {
        EXPECT_NEAR(v.grad[a][d], (p.N[a] - m.N[a]) / (2 * e), 1e-9);
        EXPECT_LT((v.hess[a].col(d) - (p.grad[a] - m.grad[a]) / (2 * e)).norm(), 1e-8);
      }
    }
  }
}

TEST(LmeScattered, OutsideTheHullThereIsNoFunction) {
  const LmeScattered basis(cube_nodes(4, 1.0), LmePrior{}, 1.0);
  EXPECT_TRUE(basis.evaluate(Vec3(1.5, 1.5, 2.9)).converged);
  EXPECT_FALSE(basis.evaluate(Vec3(1.5, 1.5, 3.1)).converged);
  EXPECT_FALSE(basis.evaluate(Vec3(1.5, 1.5, 9)).converged);
}

TEST(LmePrior, NamesEveryBrokenConstraint) {
  EXPECT_TRUE(problems(LmePrior{}).empty());
  EXPECT_TRUE(problems(LmePrior::paper()).empty());
  EXPECT_EQ(problems(LmePrior{LmePrior::Kind::CompactC2, -1, 9, 1e-4}).size(), 2u);
  EXPECT_EQ(problems(LmePrior{LmePrior::Kind::Gaussian, 0.1, 3, 1e-9}).size(), 1u);
}
