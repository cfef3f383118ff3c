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

}  // namespace umtet
