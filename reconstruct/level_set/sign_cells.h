#pragma once

#include <Eigen/Core>
#include <vector>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Cubes of one size that together hold every zero of a level set in its domain: cube (i, j, k) is
/// origin + size [i, i + 1] x [j, j + 1] x [k, k + 1].
struct SignCells {
  Vec3 origin = Vec3::Zero();
  double size = 0;
  std::vector<Eigen::Vector3i> cells;  ///< sorted by z, y, x
};

/// Lists, from coefficients alone and therefore rigorously, where psi can be zero: no component of {psi < 0} is missed,
/// however small.
///
/// On a cell of one lattice sum c_a N_a = (an affine function) + sum e_a N_a, because the N_a reproduce affine
/// functions. They are >= 0 and sum to one, so second derivatives stay below C max|e_a| / h^2 with a constant C of the
/// prior. Value and gradient in the middle of a cube together with that bound give a range of psi that closes in with
/// the square of the cube's edge; levels finer than the cube count with their least and greatest coefficient near it.
/// Cubes whose range has both signs are halved down to `size`.
///
/// @param size  the edge is the coarsest spacing / 2^k, the first at most this; > 0
/// Cost: about a microsecond for each cube near the surface. Parallel; the result does not depend on threads.
/// \throw std::invalid_argument  size not > 0, or more than 2^20 times finer than the coarsest lattice
SignCells sign_cells(const LevelSet& psi, double size);

/// The same within some cubes of an earlier search only: what it costs depends on them alone.
///
/// @param cells  of the same psi
/// @param which  indices into cells.cells, ascending
/// \throw std::invalid_argument  as above, or `size` larger than the cubes, or these are not of psi's lattices
SignCells sign_cells_within(const LevelSet& psi, const SignCells& cells, const std::vector<int>& which, double size);

}  // namespace umtet
