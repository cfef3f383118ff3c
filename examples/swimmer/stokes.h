#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "examples/swimmer/saddle_point_solver.h"

namespace umtet {

struct StokesParams {
  double viscosity = 1;            ///< mu > 0
  double stabilisation = 1. / 12;  ///< delta_K = stabilisation h_K^2 / mu; > 0
  double tolerance = 1e-6;         ///< relative residual at which the linear solver stops; in (0, 1)
  int max_iterations = 500;        ///< iterations of the linear solver; >= 1
};

/// Returns every broken constraint, not just the first.
std::vector<std::string> problems(const StokesParams&);

/// Velocities and pressures by vertex of the background; zero at vertices outside the fluid.
struct StokesFlow {
  std::vector<Vec3> u;
  std::vector<double> p;
  KrylovReport krylov;
};

/// Creeping flow, mu Lap u - grad p + f = 0 and div u = 0           [Rangarajan2018, eq. (16)], [BrezziPitkaranta1984]
///
/// in a fluid made of tets of a fixed background, whose vertices may have moved: u and p continuous, affine on tets,
///
///     int 2 mu eps(u) : eps(v) - p div v = int f v,     -int q div u - sum_K delta_K int_K (grad p - f) . grad q = 0,
///
/// u given at the fixed vertices, sigma n = 0 on the rest of the boundary. h_K^2 is the mean of the squared edges of K.
/// The second term of f keeps the scheme consistent where there is a body force [HughesFrancaBalestra1986].
///
/// Where the whole boundary is fixed, pressures are determined up to a constant, which is chosen so that their mean
/// over the fluid is zero; an unbalanced flux through the boundary (of the order of h^2 when exact velocities are
/// interpolated) is then spread evenly over the fluid.
class StokesSolver {
 public:
  /// @param background all tets of the background: the pattern of every matrix to come. Kept by reference.
  /// \throw std::invalid_argument for bad parameters or an index out of range
  StokesSolver(int n_vertices, std::span<const Tet> background, const StokesParams&);

  /// Fills the matrices for another fluid; the pattern stays.
  /// @param V     all vertices of the background; vertices of the fluid at their current positions.
  /// @param fluid numbers of background tets, connected through faces.
  /// @param fixed vertices where the velocity is given; vertices outside the fluid are ignored.
  /// \throw std::invalid_argument  the volume of a tet is not positive, or there are less than three fixed vertices
  void assemble(std::span<const Vec3> V, std::span<const int> fluid, std::span<const int> fixed);

  /// @param velocity by vertex; read at fixed vertices only.
  /// @param f        force per volume, by vertex; empty: none.
  /// \pre assemble() was called. \throw StokesError  the linear solver fails
  StokesFlow solve(std::span<const Vec3> velocity, std::span<const Vec3> f = {});

  /// Returns the force of the fluid on the object that holds vertex i, by vertex: minus the residual of the momentum
  /// equation there, -int sigma n N_i with n out of the fluid. The force on a body is the sum over its vertices, eq.
  /// (19).
  ///
  /// It is zero at vertices that are not fixed, to the tolerance of the solver, and the sum over all vertices is int f,
  /// up to rounding.
  /// @param f  the argument of solve().
  std::vector<Vec3> forces(const StokesFlow& flow, std::span<const Vec3> f = {}) const;

 private:
  std::vector<double> residual(const StokesFlow& flow, std::span<const Vec3> f) const;

  StokesParams params_;
  std::span<const Tet> background_;
  SaddlePointSolver system_;
  std::vector<Vec3> V_;
  std::vector<int> fluid_;
  std::vector<int> wet_;       // vertices of the fluid
  std::vector<char> fixed_;    // by vertex: the velocity is not an unknown
  bool enclosed_ = false;      // the whole boundary is fixed
  std::vector<double> share_;  // by vertex: int N_i
  double volume_ = 0;          // volume of the fluid
};

}  // namespace umtet
