#pragma once

#include <Eigen/Core>
#include <vector>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Cubes of equal size that together contain every zero of a level set in its domain. Cube (i, j, k) is
/// origin + size [i, i + 1] x [j, j + 1] x [k, k + 1].
struct SignCells {
  Vec3 origin = Vec3::Zero();
  double size = 0;
  std::vector<Eigen::Vector3i> cells;  ///< sorted by z, y, x
};

/// Lists the cubes in which psi may be zero. It uses the coefficients alone and is therefore rigorous: no component of
/// {psi < 0} is missed, however small.
///
/// On a cell of one lattice, sum c_a N_a = (an affine function) + sum e_a N_a, because the N_a reproduce affine
/// functions. They are >= 0 and sum to one, so second derivatives are bounded by C max|e_a| / h^2 with a constant C of
/// the prior. Value and gradient at the centre of a cube together with this bound give a range of psi, which converges
/// with the square of the cube's edge. Levels finer than the cube contribute their least and greatest coefficient near
/// it. Cubes whose range contains both signs are halved down to `size`.
///
/// @param size  upper bound, > 0: the edge is the largest of the coarsest spacing / 2^k that is at most this
/// Cost: about a microsecond per cube near the surface. Parallel; the result does not depend on threads.
/// \throw std::invalid_argument if size is not > 0, or more than 2^20 times finer than the coarsest lattice
SignCells sign_cells(const LevelSet& psi, double size);

/// Lists such cubes inside some cubes of an earlier call. The cost depends on these cubes only.
///
/// @param cells  result for the same psi
/// @param which  indices into cells.cells, ascending
/// \throw std::invalid_argument under the conditions of sign_cells(), if `size` is larger than the cubes, or if the
///        cubes do not belong to psi's lattices
SignCells sign_cells_within(const LevelSet& psi, const SignCells& cells, const std::vector<int>& which, double size);

}  // namespace umtet
