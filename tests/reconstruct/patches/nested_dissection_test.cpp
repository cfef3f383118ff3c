#include "reconstruct/patches/nested_dissection.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace umtet {
namespace {

/// A chain of squares of n x m cells with four unknowns each, and positive definite matrices.
ElementSystem cells(int n, int m, unsigned seed, Eigen::MatrixXd& A, Eigen::VectorXd& b) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  ElementSystem system;
  system.n_unknowns = (n + 1) * (m + 1);
  A = Eigen::MatrixXd::Zero(system.n_unknowns, system.n_unknowns);
  b = Eigen::VectorXd::Zero(system.n_unknowns);
  std::vector<Eigen::MatrixXd> matrices;
  std::vector<Eigen::VectorXd> sides;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const int k = j * (n + 1) + i;
      system.unknowns.push_back({k, k + 1, k + n + 1, k + n + 2});
      system.centres.emplace_back(i, j, 0);
      const Eigen::MatrixXd R = Eigen::MatrixXd::NullaryExpr(4, 4, [&] { return unit(random); });
      matrices.emplace_back(R * R.transpose() + .1 * Eigen::MatrixXd::Identity(4, 4));
      sides.emplace_back(Eigen::VectorXd::NullaryExpr(4, [&] { return unit(random); }));
      for (int p = 0; p < 4; ++p) {
        b[system.unknowns.back()[p]] += sides.back()[p];
        for (int q = 0; q < 4; ++q) A(system.unknowns.back()[p], system.unknowns.back()[q]) += matrices.back()(p, q);
      }
    }
  system.add = [matrices, sides](int e, Eigen::MatrixXd& M, Eigen::VectorXd& r) {
    M += matrices[e];
    r += sides[e];
  };
  return system;
}

TEST(NestedDissection, SolvesTheSumOfTheElements) {
  for (const auto& [n, m] : {std::pair{1, 1}, {2, 4}, {40, 1}, {17, 23}}) {
    Eigen::MatrixXd A;
    Eigen::VectorXd b;
    const ElementSystem system = cells(n, m, 3, A, b);
    const Eigen::VectorXd x = solve_by_nested_dissection(system);
    ASSERT_EQ(x.size(), b.size());
    EXPECT_LE((x - A.llt().solve(b)).norm(), 1e-9 * x.norm()) << n << " x " << m;
  }
}

TEST(NestedDissection, AMatrixThatIsNotDefiniteHasNoSolution) {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  ElementSystem system = cells(9, 9, 1, A, b);
  system.add = [add = system.add](int e, Eigen::MatrixXd& M, Eigen::VectorXd& r) {
    add(e, M, r);
    if (e == 40) M(0, 0) -= 100;
  };
  EXPECT_EQ(solve_by_nested_dissection(system).size(), 0);
}

}  // namespace
}  // namespace umtet
