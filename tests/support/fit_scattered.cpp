#include "tests/support/fit_scattered.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cmath>
#include <cstddef>

#include "common/formatted.h"
#include "reconstruct/solve/solve_error.h"

namespace umtet {
namespace {

// w_v N N^T + w_g grad N . grad N^T of one sample; B has the columns N, N_x, N_y, N_z.
Eigen::MatrixXd sample_block(const Eigen::MatrixX4d& B, double w_value, double w_gradient) {
  return B * Eigen::Vector4d(w_value, w_gradient, w_gradient, w_gradient).asDiagonal() * B.transpose();
}

// A symmetric sparse matrix whose pattern is known: blocks of ascending node lists are merged into ascending columns.
class PatternMatrix {
 public:
  explicit PatternMatrix(const LmeScattered& basis) : n_(static_cast<int>(basis.nodes().size())) {
    begin_.push_back(0);
    for (int a = 0; a < n_; ++a) {
      for (const int b : basis.overlapping(a)) row_.push_back(b);
      begin_.push_back(row_.size());
    }
    value_.assign(row_.size(), 0.0);
  }
  void add(const std::vector<int>& nodes, const Eigen::MatrixXd& block) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      std::size_t at = begin_[nodes[a]];
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        while (row_[at] != nodes[b]) ++at;
        value_[at] += block(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(a));
      }
    }
  }
  Eigen::SparseMatrix<double> matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int a = 0; a < n_; ++a)
      for (std::size_t i = begin_[a]; i < begin_[a + 1]; ++i) entries.emplace_back(row_[i], a, value_[i]);
    Eigen::SparseMatrix<double> A(n_, n_);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }

 private:
  int n_;
  std::vector<std::size_t> begin_;
  std::vector<int> row_;
  std::vector<double> value_;
};

void add_hessian_energy(const LmeScattered& basis, double weight, double quadrature_cell, PatternMatrix& A) {
  Vec3 low = basis.nodes().front(), high = low;
  for (const Vec3& p : basis.nodes()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Eigen::Vector3i cells = ((high - low) / quadrature_cell).array().ceil().max(1).cast<int>();
  const Vec3 cell = (high - low).cwiseQuotient(cells.cast<double>());
  const double gauss = 0.5 / std::sqrt(3.0);
  for (int q = 0; q < 8 * cells.prod(); ++q) {
    const int c = q / 8;
    const Vec3 side((q & 1) ? gauss : -gauss, (q & 2) ? gauss : -gauss, (q & 4) ? gauss : -gauss);
    const Eigen::Vector3i at(c % cells[0], c / cells[0] % cells[1], c / (cells[0] * cells[1]));
    const LmeValues v = basis.evaluate(low + (at.cast<double>() + Vec3::Constant(0.5) + side).cwiseProduct(cell));
    if (!v.converged) continue;
    Eigen::MatrixXd H(v.node.size(), 9);
    for (std::size_t a = 0; a < v.node.size(); ++a) {
      H.row(static_cast<Eigen::Index>(a)) = Eigen::Map<const Eigen::Matrix<double, 1, 9>>(v.hess[a].data());
    }
    A.add(v.node, weight * cell.prod() / 8 * H * H.transpose());
  }
}

}  // namespace

std::vector<double> fit_scattered(const LmeScattered& basis, const std::vector<SsdSample>& samples,
                                  double energy_weight, double quadrature_cell) {
  const Eigen::Index n = static_cast<Eigen::Index>(basis.nodes().size());
  PatternMatrix A(basis);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SsdSample& s = samples[i];
    const LmeValues v = basis.evaluate(s.xi);
    if (!v.converged) {
      throw SolveError(formatted("sample %zu at (%.6g, %.6g, %.6g) lies outside the hull of the %zu nodes", i, s.xi[0],
                                 s.xi[1], s.xi[2], n));
    }
    Eigen::MatrixX4d B(v.node.size(), 4);
    for (std::size_t a = 0; a < v.node.size(); ++a) {
      B.row(static_cast<Eigen::Index>(a)) << v.N[a], v.grad[a].transpose();
      r[v.node[a]] += s.w_gradient * v.grad[a].dot(s.normal) + s.w_value * s.value * v.N[a];
    }
    A.add(v.node, sample_block(B, s.w_value, s.w_gradient));
  }
  add_hessian_energy(basis, energy_weight, quadrature_cell, A);
  const Eigen::SparseMatrix<double> matrix = A.matrix();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(matrix);
  if (ldlt.info() != Eigen::Success) throw SolveError("the factorisation failed");
  Eigen::VectorXd c = ldlt.solve(r);
  c += ldlt.solve(r - matrix * c);  // one step of refinement: the condition grows as h^-4
  return {c.data(), c.data() + c.size()};
}

}  // namespace umtet
