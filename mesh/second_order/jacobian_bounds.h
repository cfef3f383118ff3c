#pragma once

#include <array>

#include "mesh/core/quadratic_tet_mesh.h"

namespace umtet {

using QuadraticNodes = std::array<Vec3, 10>;  ///< nodes of one tet, in the order of QuadraticTet

/// The nodes of a ten-node tet.
inline QuadraticNodes nodes_of(const QuadraticTetMesh& mesh, const QuadraticTet& tet) {
  QuadraticNodes x;
  for (int n = 0; n < 10; ++n) x[n] = mesh.V[tet[n]];
  return x;
}

/// Columns of the Jacobian of the quadratic map, which are linear in l, by their values a[i] at the corners.
///
/// With the ten control points of x(l) = sum b_ij l_i l_j over all ordered pairs,
///
///     dx/dl_j - dx/dl_0 = sum_i l_i a[i][j - 1],   a[i][j - 1] = 2 (b_ij - b_i0),
///     b_ii = V_i,   b_ij = 2 m_ij - (V_i + V_j) / 2   with m_ij the mid-side.
using JacobianColumns = std::array<std::array<Vec3, 3>, 4>;
JacobianColumns jacobian_columns(const QuadraticNodes& x);

/// Index of the Bernstein polynomial of l_i l_j l_k among the twenty cubic ones, for any order of i, j, k.
extern const std::array<std::array<std::array<int, 4>, 4>, 4> kCubicIndex;
/// The number of different orders of (i, j, k): 1, 3 or 6.
extern const std::array<int, 20> kCubicOrders;

/// Bernstein coefficients of det dx/dl, which is a cubic polynomial:
///
///     c_{ijk} = mean over the orders of (i, j, k) of det(a[i][0], a[j][1], a[k][2]);
///
/// the values of the determinant lie between the least and the greatest coefficient, and the mean of the coefficients
/// is six times the volume.
struct JacobianCoefficients {
  std::array<double, 20> c;
  double rounding;  ///< bound on the difference of each c from its exact value for these nodes
};
JacobianCoefficients jacobian_coefficients(const QuadraticNodes& x);

/// Six times the volume of the image of the tet, which is the mean of the coefficients.
double mean_jacobian(const JacobianCoefficients&);

/// Proved bounds on the least value of det dx/dl on the closed tet.
struct JacobianBounds {
  double lower, upper;  ///< lower <= min det <= upper, rounding errors included
  double mean;          ///< six times the volume

  /// True if the map is proved to be locally one to one everywhere in the tet.
  bool positive() const { return lower > 0; }
  /// Lower bound of min det / mean det, which is 1 for straight edges with nodes at their middles; -1 if the mean is
  /// not positive.
  double scaled_lower() const { return mean > 0 ? lower / mean : -1; }
};

/// Bounds min det dx/dl by the Bernstein coefficients. If these are farther apart than a fiftieth of the upper bound,
/// the tet is subdivided (de Casteljau), halving the edge along which the coefficients bend most.
///
/// A tet is given up as soon as its determinant is known not to be positive at some point. A tet that is undecided
/// after some thousand parts is given up with lower <= 0.
/// \note for coordinates that are not finite, lower = -infinity
/// Cost: .3 microseconds where the coefficients decide. Does not allocate.
JacobianBounds jacobian_bounds(const QuadraticNodes& x);

}  // namespace umtet
