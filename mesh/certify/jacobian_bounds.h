#pragma once

#include <array>

#include "mesh/core/quadratic_tet_mesh.h"

namespace umtet {

using QuadraticNodes = std::array<Vec3, 10>;  ///< of one tet, in the order of QuadraticTet

inline QuadraticNodes nodes_of(const QuadraticTetMesh& mesh, const QuadraticTet& tet) {
  QuadraticNodes x;
  for (int n = 0; n < 10; ++n) x[n] = mesh.V[tet[n]];
  return x;
}

/// The ten control points of x(l) = sum b_ij l_i l_j over all ordered pairs, less the first corner, by their
/// differences: the columns of the Jacobian are linear,
///
///     dx/dl_j - dx/dl_0 = sum_i l_i a[i][j - 1],   a[i][j - 1] = 2 (b_ij - b_i0),
///     b_ii = V_i,   b_ij = 2 m_ij - (V_i + V_j) / 2   with m_ij the mid-side.
using JacobianColumns = std::array<std::array<Vec3, 3>, 4>;
JacobianColumns jacobian_columns(const QuadraticNodes& x);

/// Place of the Bernstein polynomial of l_i l_j l_k among the twenty cubic ones, in any order of i, j, k.
extern const std::array<std::array<std::array<int, 4>, 4>, 4> kCubicIndex;
/// In how many orders: 1, 3 or 6.
extern const std::array<int, 20> kCubicOrders;

/// det dx/dl is a cubic polynomial. These are its Bernstein coefficients,
///
///     c_{ijk} = mean over the orders of (i, j, k) of det(a[i][0], a[j][1], a[k][2]);
///
/// its values lie between the least and the greatest, and their mean is six times the volume.
struct JacobianCoefficients {
  std::array<double, 20> c;
  double rounding;  ///< no c is farther than this from what exact arithmetic gives for these nodes
};
JacobianCoefficients jacobian_coefficients(const QuadraticNodes& x);

/// Six times the volume of the image of the tet: the mean of the coefficients.
double mean_jacobian(const JacobianCoefficients&);

/// What is proved of the least value of det dx/dl on the closed tet.
struct JacobianBounds {
  double lower, upper;  ///< lower <= min det <= upper, errors of rounding included
  double mean;          ///< six times the volume

  /// Says that the map is locally one to one everywhere in the tet.
  bool positive() const { return lower > 0; }
  /// min det / mean det, 1 for straight edges with nodes at their middles; a lower bound. -1 where nothing is positive.
  double scaled_lower() const { return mean > 0 ? lower / mean : -1; }
};

/// Bounds by the coefficients, and where these are farther apart than a fiftieth of the upper bound, by those of ever
/// smaller parts of the tet (de Casteljau, halving the edge along which the coefficients bend most). A tet whose
/// determinant is not positive at some point is given up where that is known; so is one that is not decided after
/// some thousand parts, with lower <= 0.
/// \note not finite coordinates: lower = -infinity
/// Cost: .3 microseconds where the coefficients decide. Does not allocate.
JacobianBounds jacobian_bounds(const QuadraticNodes& x);

}  // namespace umtet
