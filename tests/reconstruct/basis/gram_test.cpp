// The Hessian-energy operator against the energy of functions whose integral is known or sampled.

#include "common/vec3.h"
#include "reconstruct/basis/gram.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <random>

#include "reconstruct/solve/ssd_assembled.h"

using namespace umtet;

namespace {

std::vector<double> random_vector(std::ptrdiff_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<double> v(n);
  for (double& x : v) x = unit(random);
  return v;
}

}  // namespace

TEST(HessianEnergy, VanishesOnAffineFunctionsOnly) {
  const LmeTables tables{LmePrior{}};
  const Eigen::Vector3i n(9, 7, 8);
  const HessianEnergy K(tables, n);
  std::vector<double> c(n.prod()), y(n.prod()), work;
  for (int k = 0, a = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) c[a++] = 2 - 0.5 * i + 1.5 * j + 0.25 * k;
  K.apply(1, c.data(), y.data(), work);
  for (const double v : y) EXPECT_NEAR(v, 0, 1e-6);
  c = random_vector(n.prod(), 1);
  K.apply(1, c.data(), y.data(), work);
  double energy = 0;
  for (int a = 0; a < n.prod(); ++a) energy += c[a] * y[a];
  EXPECT_GT(energy, 1);
}

TEST(HessianEnergy, AppliedEqualsItsEntries) {
  for (const int support : {2, 3, 4}) {
    const LmeTables tables({LmePrior::Kind::CompactC2, 1.2, support, 1e-4});
    for (const Eigen::Vector3i& n :
         {Eigen::Vector3i(8, 33, 9), Eigen::Vector3i(53, 9, 8)}) {  // short rows; a row with an interior
      const HessianEnergy K(tables, n);
      const std::vector<double> c = random_vector(n.prod(), 2);
      std::vector<double> y(n.prod()), work;
      K.apply(0.5, c.data(), y.data(), work);
      for (const Eigen::Vector3i& a : {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(n / 2),
                                       Eigen::Vector3i(n - Eigen::Vector3i::Ones()), Eigen::Vector3i(n[0] / 3, 2, 5)}) {
        double sum = 0;
        Eigen::Vector3i b;
        int at = 0;
        for (b[2] = 0; b[2] < n[2]; ++b[2])
          for (b[1] = 0; b[1] < n[1]; ++b[1])
            for (b[0] = 0; b[0] < n[0]; ++b[0]) sum += 0.5 * K.entry(a, b) * c[at++];
        EXPECT_NEAR(y[a[0] + n[0] * (a[1] + n[1] * a[2])], sum, 1e-12 * std::max(1.0, std::abs(sum)));
      }
    }
  }
}

TEST(HessianEnergy, IsTheIntegralOfTheSquaredHessian) {
  // f with random coefficients: cT K c against Gauss-free sampling of H:H on a fine midpoint grid.
  const LmeTables tables{LmePrior{}};
  const Eigen::Vector3i n(7, 6, 6);
  const HessianEnergy K(tables, n);
  const std::vector<double> c = random_vector(n.prod(), 3);
  std::vector<double> y(n.prod()), work;
  K.apply(1, c.data(), y.data(), work);
  double energy = 0;
  for (int a = 0; a < n.prod(); ++a) energy += c[a] * y[a];

  const int m = 12;
  double sampled = 0;
  std::vector<LmeBasis1d> B[3];
  for (int d = 0; d < 3; ++d)
    for (int q = 0; q < m * (n[d] - 1); ++q) B[d].push_back(evaluate_lme_1d(tables.prior(), n[d], (q + 0.5) / m));
  for (const LmeBasis1d& z : B[2])
    for (const LmeBasis1d& y1 : B[1])
      for (const LmeBasis1d& x : B[0]) {
        double h[6] = {};
        for (int k = 0; k < 6; ++k)
          for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 6; ++i) {
              const double v = c[x.first + i + n[0] * (y1.first + j + n[1] * (z.first + k))];
              h[0] += v * x.ddN[i] * y1.N[j] * z.N[k], h[1] += v * x.N[i] * y1.ddN[j] * z.N[k];
              h[2] += v * x.N[i] * y1.N[j] * z.ddN[k], h[3] += v * x.dN[i] * y1.dN[j] * z.N[k];
              h[4] += v * x.dN[i] * y1.N[j] * z.dN[k], h[5] += v * x.N[i] * y1.dN[j] * z.dN[k];
            }
        sampled += h[0] * h[0] + h[1] * h[1] + h[2] * h[2] + 2 * (h[3] * h[3] + h[4] * h[4] + h[5] * h[5]);
      }
  sampled /= m * m * m;
  EXPECT_NEAR(energy / sampled, 1, 2e-3);  // the midpoint rule's own error at 12 points a cell
}

TEST(SsdOperator, AppliedEqualsAssembled) {
  for (const LmePrior& prior : {LmePrior{}, LmePrior::paper(), LmePrior{LmePrior::Kind::CompactC2, 0.8, 4, 1e-4}}) {
    const LmeTables tables(prior);
    const Eigen::Vector3i n(10, 9, 12);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<SsdSample> samples(100);
    for (SsdSample& s : samples) {
      s.xi = Vec3(unit(random), unit(random), unit(random)).cwiseProduct((n.array() - 1).cast<double>().matrix());
      s.normal = Vec3(unit(random), unit(random), 1).normalized();
      s.w_value = unit(random), s.w_gradient = unit(random);
    }
    const SsdOperator op(tables, n, 0.3, samples);
    const Eigen::SparseMatrix<double> A = assemble(op);
    std::vector<double> c = random_vector(n.prod(), 4), y(n.prod() + SsdOperator::kPad), d(n.prod()), work;
    c.resize(c.size() + SsdOperator::kPad, 0.0);
    op.apply(c.data(), y.data(), work);
    op.diagonal(d.data());
    const Eigen::VectorXd expected = A * Eigen::Map<Eigen::VectorXd>(c.data(), n.prod());
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(y.data(), n.prod()) - expected).norm(), 1e-12 * expected.norm());
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(d.data(), n.prod()) - A.diagonal()).norm(), 1e-12 * A.diagonal().norm());
    EXPECT_LT((Eigen::MatrixXd(A) - Eigen::MatrixXd(A).transpose()).norm(), 1e-12 * A.norm());
  }
}

TEST(SsdOperator, InSinglePrecisionIsTheSameRounded) {
  const LmeTables tables{LmePrior{}};
  for (const Eigen::Vector3i& n : {Eigen::Vector3i(7, 9, 8), Eigen::Vector3i(13, 9, 8), Eigen::Vector3i(53, 9, 8)}) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<SsdSample> samples(100);
    for (SsdSample& s : samples) {
      s.xi = Vec3(unit(random), unit(random), unit(random)).cwiseProduct((n.array() - 1).cast<double>().matrix());
      s.w_value = unit(random), s.w_gradient = unit(random);
    }
    SsdOperator op(tables, n, 0.3, samples);
    op.tabulate();
    std::vector<double> c = random_vector(n.prod(), 4), y(n.prod() + SsdOperator::kPad), work;
    c.resize(c.size() + SsdOperator::kPad, 0.0);
    const std::vector<float> single(c.begin(), c.end());
    std::vector<float> rounded(y.size()), single_work;
    op.apply(c.data(), y.data(), work);
    op.apply(single.data(), rounded.data(), single_work);
    const Eigen::Map<Eigen::VectorXd> expected(y.data(), n.prod());
    const Eigen::Map<Eigen::VectorXf> made(rounded.data(), n.prod());
    EXPECT_LT((made.cast<double>() - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST(SsdOperator, ApplyIsTheSameForAnyThreads) {
  // Samples in two layers of cells only, so that their slabs run at the same time: the highest layer, where windows of
  // functions are moved down from the hull, and each below that such a window may reach. Twelve heights: every
  // remainder of slabs up to twelve layers thick.
  constexpr int kSamples = 200, kTrials = 4;
  for (const int support : {2, 3, 4}) {
    const LmeTables tables({LmePrior::Kind::CompactC2, 1.2, support, 1e-4});
    for (int nz = 26; nz < 38; ++nz) {
      const Eigen::Vector3i n(8, 8, nz);
      const int top = nz - 2;
      std::mt19937_64 random(nz);
      std::uniform_real_distribution<double> unit(0, 1);
      for (int below = 3; below <= 3 * support; ++below) {
        std::vector<SsdSample> samples(2 * kSamples);
        for (std::size_t i = 0; i < samples.size(); ++i) {
          SsdSample& s = samples[i];
          s.xi = Vec3(7 * unit(random), 7 * unit(random), (i % 2 ? top : top - below) + unit(random));
          s.normal = Vec3::UnitZ();
          s.w_value = s.w_gradient = 1;
        }
        const SsdOperator op(tables, n, 0.3, samples);
        std::vector<double> c = random_vector(n.prod(), 5), one(n.prod() + SsdOperator::kPad), two(one), work;
        c.resize(c.size() + SsdOperator::kPad, 0.0);
        {
          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
          op.apply(c.data(), one.data(), work);
        }
        for (int trial = 0; trial < kTrials; ++trial) {
          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
          op.apply(c.data(), two.data(), work);
          ASSERT_EQ(std::memcmp(one.data(), two.data(), n.prod() * sizeof(double)), 0)
              << "R " << support << " n_z " << nz << " layers " << below << " apart";
        }
      }
    }
  }
}
