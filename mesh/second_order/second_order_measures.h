#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "mesh/core/implicit_function.h"
#include "mesh/second_order/jacobian_bounds.h"

// Contributions of tets, mid-sides and faces to a SecondOrderCertificate, for callers with a part of a mesh each.
namespace umtet {

/// Number of consecutive tets that are summed first, before their sums are added in order.
inline constexpr std::size_t kCurvedTetsPerSum = 1 << 9;

/// Sums and extrema over tets.
struct JacobianMeasure {
  double volume = 0;
  double lower = std::numeric_limits<double>::infinity(), upper = lower;  ///< bounds on min det / mean det
  std::size_t n_nonpositive = 0;

  void add(const JacobianBounds& b);
  void add(const JacobianMeasure& next);
};

/// |psi| / |grad psi|; infinite where it is not a number.
double slope_distance(ImplicitFunctionRef psi, const Vec3& x);

/// Distances from a curved face to psi = 0 at its centroid and half-way from there to its corners: |psi| / |grad psi|
/// where this is small against h, else the distance to the closest point.
/// @param x  nodes of the face, in the order of QuadraticTriangle
std::array<double, 4> curved_face_distances(ImplicitFunctionRef psi, const std::array<Vec3, 6>& x, double h);

}  // namespace umtet
