#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "mesh/certify/jacobian_bounds.h"
#include "mesh/core/implicit_function.h"

// What tets, mid-sides and faces add to a SecondOrderCertificate, for those who have a part of a mesh each.
namespace umtet {

/// Consecutive tets that are summed by themselves, before the sums are added one after the other.
inline constexpr std::size_t kCurvedTetsPerSum = 1 << 9;

/// Sums and extremes over tets.
struct JacobianMeasure {
  double volume = 0;
  double lower = std::numeric_limits<double>::infinity(), upper = lower;  ///< of min det / mean det
  std::size_t n_nonpositive = 0;

  void add(const JacobianBounds& b);
  void add(const JacobianMeasure& next);
};

/// |psi| / |grad psi|; infinite where that is not a number.
double slope_distance(ImplicitFunctionRef psi, const Vec3& x);

/// Of a curved face at its centroid and half-way from there to its corners: the same where that is small against h,
/// else to the closest point. @param x  its nodes, in the order of QuadraticTriangle
std::array<double, 4> curved_face_distances(ImplicitFunctionRef psi, const std::array<Vec3, 6>& x, double h);

}  // namespace umtet
