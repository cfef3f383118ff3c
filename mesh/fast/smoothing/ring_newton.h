#pragma once

#include <Eigen/Core>
#include <bitset>
#include <limits>

#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"

namespace umtet::detail {

// Newton's method for one ring in PNormSmoother: the p-norm of 1/Q over the ring, the Newton steps, and the test that
// accepts a step. F is Q^-3 of a tet, without the factor 1 / 432 except in power_sum(): scaling cancels it.

/// The exponent p of the norm of 1/Q by which positions are compared.
inline constexpr double kNorm = 96;

/// Fills the last SIMD pack with tets of F = 0 instead of copies, which would count twice in a sum. Needed by all
/// functions below except power_sum().
void silence_padding(OneRing& ring);

/// Allowed directions of a vertex: all of space, a plane, or a line.
struct Directions {
  bool plane = false;
  Eigen::Matrix<double, 3, 2> tangents;
  bool line = false;  ///< the first tangent alone; then `plane` is not looked at
};

/// The quality of the ring at y = 0, which a new position must exceed.
struct Bar {
  double scale;                                          ///< the greatest F
  double sum = std::numeric_limits<double>::infinity();  ///< sum of (F / scale)^p for the last p, if all V > 0
  double least_volume = 0;                               ///< min V otherwise
  double least_gain = 0;  ///< relative gain of the norm, or of min V in units of a background tet's volume

  Bar(const OneRing& ring, double h, double gain);
  bool tangled() const { return sum == std::numeric_limits<double>::infinity(); }
  bool passed(const OneRing& ring, const Vec3& y) const;
  bool passed(double sum_there) const { return sum_there < sum * (1 - least_gain); }
};

/// A displacement y of a vertex, with the sum that a Bar judges.
struct Displacement {
  Vec3 y;
  double sum;  ///< Bar::sum at y; NaN if the bar is tangled

  bool passed(const OneRing& ring, const Bar& bar) const {
    return bar.tangled() ? bar.passed(ring, y) : bar.passed(sum);
  }
};

/// The best displacement of a vertex in these directions that one solve finds.
Displacement best_displacement(const OneRing& ring, const Bar& bar, double h, const Directions& directions);

/// The tets of the ring for which 1/F, with the sign of V, is below `good_f` at 0 or at y.
std::bitset<kMaxRing> tets_below_target(const OneRing& ring, const Vec3& y, double good_f);

/// A power sum over a ring, with the derivatives of its logarithm.
struct PowerSum {
  double sum = 0;                ///< infinite if some V <= 0
  Vec3 gradient = Vec3::Zero();  ///< gradient of ln(sum) / p
  Mat3 hessian = Mat3::Zero();   ///< Hessian of ln(sum) / p
};

/// sum_j (F_j(y) / scale)^p over a ring, p = 2^log2_p, and the derivatives of ln(sum) / p, from which the Newton steps
/// are made.
/// \throw std::invalid_argument for a log2_p that is not among the steps
PowerSum power_sum(const OneRing& ring, const Vec3& y, int log2_p, double scale);

}  // namespace umtet::detail
