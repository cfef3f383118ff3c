#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The linear solver has failed; the message contains unknowns, iterations and residual.
struct StokesError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct KrylovReport {
  int iterations = 0;
  double residual = 0;  ///< relative to the initial residual, both in the norm of the preconditioner
};

/// Symmetric systems with four unknowns per node, three velocities and a pressure, on a fixed pattern.
///
/// MINRES with a block-diagonal preconditioner [Elman2014, Section 4.2]: BoomerAMG of a *scalar* stiffness matrix for
/// each velocity component, spectrally equivalent to the coupled block by Korn's inequality, and a diagonal for the
/// pressure. Products with the matrix use all threads, everything else one thread; the bytes of results do not depend
/// on the number of threads.
///
/// Only this class uses PETSc and hypre. The first object starts them (and MPI, without a launcher) for the process,
/// without PETSc's signal handlers, option file and messages.
class SaddlePointSolver {
 public:
  /// The pattern couples every two nodes of a tet.
  SaddlePointSolver(int n_nodes, std::span<const Tet> tets);
  ~SaddlePointSolver();

  void clear();  ///< sets all values to zero

  /// Returns the block of the rows of node i and the columns of node j. \pre i and j share a tet
  Eigen::Map<Eigen::Matrix4d> block(int i, int j) { return Eigen::Map<Eigen::Matrix4d>(&blocks_[16 * at(i, j)]); }
  /// The matrix that approximates the block of one velocity component; positive definite when complete.
  double& stiffness(int i, int j) { return stiffness_[at(i, j)]; }
  /// The diagonal that approximates the Schur complement; > 0 when complete.
  double& pressure_weight(int i) { return pressure_weight_[std::size_t(i)]; }

  void set_up();  ///< call it when the values are complete

  /// Solves K x = b from x = 0; b[4 i + c]. K may be singular if b is in its range, because MINRES supports this.
  /// \throw StokesError  it takes more than max_iterations, or breaks down
  KrylovReport solve(std::span<const double> b, std::span<double> x, double tolerance, int max_iterations);

 private:
  std::size_t at(int i, int j) const;               ///< position of (i, j) in the pattern
  void multiply(const double* x, double* y) const;  ///< y = K x, rows in parallel

  struct Petsc;
  std::vector<int> row_, column_;  // compressed rows of nodes, sorted
  std::vector<double> blocks_;     // column-major 4 x 4, one after the other
  std::vector<double> stiffness_, pressure_weight_;
  std::unique_ptr<Petsc> petsc_;  // refers to the four arrays above
};

}  // namespace umtet
