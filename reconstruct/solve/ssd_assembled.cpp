#include "reconstruct/solve/ssd_assembled.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/formatted.h"
#include "reconstruct/solve/solve_error.h"

namespace umtet {

namespace {

// w_v N N^T + w_g grad N . grad N^T of one sample; B has the columns N, N_x, N_y, N_z.
Eigen::MatrixXd sample_block(const Eigen::MatrixX4d& B, double w_value, double w_gradient) {
  return B * Eigen::Vector4d(w_value, w_gradient, w_gradient, w_gradient).asDiagonal() * B.transpose();
}

// Samples whose blocks are held at a time: of 6 nodes an axis 370 kB each.
constexpr std::size_t kAtOnce = 16;

// What a sample adds to the matrix, over the nodes whose functions reach it, x fastest.
struct SampleBlock {
  Eigen::Vector3i first;
  Eigen::MatrixX4d B;
  Eigen::MatrixXd entries;

  void make(const LmeTables& tables, const Eigen::Vector3i& n, const SsdSample& s) {
    const int W = tables.width();
    LmeBasis3d N;
    evaluate_lme_3d<false>(tables, n, s.xi, N);
    first = {N.x.first, N.y.first, N.z.first};
    B.resize(W * W * W, 4);
    for (int k = 0, a = 0; k < W; ++k)
      for (int j = 0; j < W; ++j)
        for (int i = 0; i < W; ++i, ++a) {
          B.row(a) << N.x.N[i] * N.y.N[j] * N.z.N[k], N.x.dN[i] * N.y.N[j] * N.z.N[k], N.x.N[i] * N.y.dN[j] * N.z.N[k],
              N.x.N[i] * N.y.N[j] * N.z.dN[k];
        }
    entries = sample_block(B, s.w_value, s.w_gradient);
  }
  Eigen::Vector3i node(int a, int W) const { return first + Eigen::Vector3i(a % W, a / W % W, a / (W * W)); }
};

std::vector<double> solve(const Eigen::SparseMatrix<double>& A, const Eigen::VectorXd& r) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(A);
  if (ldlt.info() != Eigen::Success) {
    throw SolveError(
        formatted("sparse factorisation of %td nodes failed: the matrix is not positive definite", A.rows()));
  }
  Eigen::VectorXd c = ldlt.solve(r);
  c += ldlt.solve(r - A * c);  // one step of refinement: the condition grows as h^-4
  return {c.begin(), c.end()};
}

}  // namespace

Eigen::SparseMatrix<double> assemble(const SsdOperator& op) {
  const Eigen::Vector3i& n = op.n();
  const int W = op.tables().width(), half = W - 1, D = 2 * half + 1;
  const Lattice lattice{Eigen::Vector3d::Zero(), 1.0, n};
  // Every row has the same D^3 neighbours: values are added in place, with no list of entries to sort.
  const auto slot = [&](const Eigen::Vector3i& offset) {
    return (static_cast<std::ptrdiff_t>(offset[2] + half) * D + offset[1] + half) * D + offset[0] + half;
  };
  const std::ptrdiff_t row_size = static_cast<std::ptrdiff_t>(D) * D * D;
  std::vector<double> values(static_cast<std::size_t>(row_size * op.size()), 0.0);

  // Blocks of some samples are made side by side; then each layer of rows gets what they add to it, in their order: the
  // same bits for any number of threads.
  const std::vector<SsdSample>& samples = op.samples();
  std::vector<SampleBlock> blocks(std::min(kAtOnce, samples.size()));
  for (std::size_t begin = 0; begin < samples.size(); begin += blocks.size()) {
    const std::size_t n_blocks = std::min(blocks.size(), samples.size() - begin);
    tbb::parallel_for(std::size_t{0}, n_blocks,
                      [&](std::size_t s) { blocks[s].make(op.tables(), n, samples[begin + s]); });
    tbb::parallel_for(0, n[2], [&](int z) {
      for (std::size_t s = 0; s < n_blocks; ++s) {
        const SampleBlock& block = blocks[s];
        if (z < block.first[2] || z >= block.first[2] + W) continue;
        for (int a = W * W * (z - block.first[2]); a < W * W * (z - block.first[2] + 1); ++a) {
          const Eigen::Vector3i at = block.node(a, W);
          double* row = values.data() + row_size * lattice.index(at[0], at[1], at[2]);
          for (int b = 0; b < W * W * W; b += W) {  // W neighbours along x have W slots one after the other
            double* to = row + slot(block.node(b, W) - at);
            for (int i = 0; i < W; ++i) to[i] += block.entries(b + i, a);
          }
        }
      }
    });
  }

  Eigen::SparseMatrix<double> A(op.size(), op.size());
  A.reserve(Eigen::VectorXi::Constant(op.size(), static_cast<int>(std::min<std::ptrdiff_t>(row_size, op.size()))));
  Eigen::Vector3i a, b;
  for (a[2] = 0; a[2] < n[2]; ++a[2])
    for (a[1] = 0; a[1] < n[1]; ++a[1])
      for (a[0] = 0; a[0] < n[0]; ++a[0]) {
        const auto row = lattice.index(a[0], a[1], a[2]);
        const AxisGram &x = op.energy().axis(0), &y = op.energy().axis(1), &z = op.energy().axis(2);
        for (b[2] = std::max(0, a[2] - half); b[2] <= std::min(n[2] - 1, a[2] + half); ++b[2])
          for (b[1] = std::max(0, a[1] - half); b[1] <= std::min(n[1] - 1, a[1] + half); ++b[1]) {
            // entry(a, b), what depends on y and z taken out of the sum
            const double my = y.m(a[1], b[1]), sy = y.s(a[1], b[1]), mz = z.m(a[2], b[2]), sz = z.s(a[2], b[2]);
            const double with_m = op.kappa() * (y.b(a[1], b[1]) * mz + my * z.b(a[2], b[2]) + 2 * sy * sz),
                         with_b = op.kappa() * my * mz, with_s = op.kappa() * 2 * (sy * mz + my * sz);
            for (b[0] = std::max(0, a[0] - half); b[0] <= std::min(n[0] - 1, a[0] + half); ++b[0]) {
              A.insert(lattice.index(b[0], b[1], b[2]), row) = values[row_size * row + slot(b - a)] +
                                                               x.m(a[0], b[0]) * with_m + x.b(a[0], b[0]) * with_b +
                                                               x.s(a[0], b[0]) * with_s;
            }
          }
      }
  A.makeCompressed();
  return A;
}

std::vector<double> solve_assembled(const SsdOperator& op) {
  Eigen::VectorXd r(op.size() + SsdOperator::kPad);
  op.right_hand_side(r.data());
  return solve(assemble(op), r.head(op.size()));
}

namespace {

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
  return solve(A.matrix(), r);
}

}  // namespace umtet
