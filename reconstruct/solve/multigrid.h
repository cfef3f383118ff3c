#pragma once

#include <Eigen/Cholesky>
#include <functional>
#include <vector>

#include "reconstruct/solve/ssd_operator.h"

namespace umtet {

/// Prolongation of coefficients along one axis, from n_coarse nodes to 2 n_coarse - 1.
///
/// Coefficients are not samples: a function with coefficients c is c smoothed by a kernel of variance h^2 / (2 gamma),
/// so coefficients sampled from the coarse function would be smoothed twice. The coarse max-ent functions with gamma_P
/// = 4 gamma / 3 have the missing variance: (2h)^2 / (2 gamma_P) = (2h)^2 / (2 gamma) - h^2 / (2 gamma).
struct AxisProlongation {
  int n_coarse = 0, n_fine = 0, width = 0;
  std::vector<int> first;     ///< first coarse node of each fine node
  std::vector<float> weight;  ///< width weights for each fine node

  AxisProlongation(const LmePrior& prior, int n_coarse);
};

/// Multigrid preconditioner: a symmetric V-cycle for an SsdOperator on lattices h, 2h, 4h, ..., each re-discretised,
/// with Chebyshev-Jacobi smoothing and dense Cholesky on the coarsest. If a level has many samples per cell, its
/// operator is built from their weighted means; this changes the preconditioner, but not the solution. All but the
/// factor is in single precision, because PCG needs one digit at a time.
class Multigrid {
 public:
  /// @param n_levels  the lattice's cells along each axis must be divisible by 2^(n_levels - 1)
  Multigrid(const SsdOperator& finest, int n_levels);

  /// z = M^-1 r, a fixed symmetric positive definite operator. `r`, `z`: size() + kPad doubles.
  void apply(const double* r, double* z);
  int n_levels() const { return static_cast<int>(levels_.size()); }

 private:
  struct Level {
    SsdOperator op;
    std::vector<float> inverse_diagonal;
    double lambda_max = 0;             // of D^-1 A
    std::vector<AxisProlongation> up;  // three axes, from the next coarser level
    std::vector<float> x, r, d, Ad;    // iterate, residual, Chebyshev direction
  };
  void cycle(std::size_t level);
  void smooth(Level& level, bool before);

  std::vector<Level> levels_;
  Eigen::LLT<Eigen::MatrixXd> coarsest_;
  std::vector<float> workspace_, transfer_;
};

/// Convergence history of solve_pcg().
struct PcgReport {
  int iterations = 0;
  bool converged = false;
  std::vector<double> residuals;  ///< |r_k| / |r_0|, the first is 1
};

/// Preconditioned conjugate gradient method for A c = b from c = 0.
/// @param c  size() + kPad doubles, overwritten
/// @param progress  called once per iteration with the relative residual; its exceptions are passed on
PcgReport solve_pcg(const SsdOperator& A, Multigrid& M, const std::vector<double>& b, double tolerance,
                    int max_iterations, std::vector<double>& c, const std::function<void(double)>& progress);

}  // namespace umtet
