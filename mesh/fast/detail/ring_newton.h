#pragma once

#include <Eigen/Core>
#include <bitset>
#include <limits>

#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"

namespace umtet::detail {

// What PNormSmoother does to one ring: the p-norm of its 1/Q, Newton steps on it, and what a step is judged by. F is
// Q^-3 of a tet, without the factor 1 / 432 except in power_sum(): scales take it out again.

/// The p of 1/Q's norm by which places are compared.
inline constexpr double kNorm = 96;

/// Fills up the last SIMD pack with tets of F = 0 in place of copies, which would count twice in a sum. For all that
/// follows but power_sum().
void silence_padding(OneRing& ring);

/// Where a vertex may step: everywhere, or along a plane.
struct Directions {
  bool plane = false;
  Eigen::Matrix<double, 3, 2> tangents;
};

/// What a place has to be better than: the ring at y = 0.
struct Bar {
  double scale;                                          ///< of F: its greatest value
  double sum = std::numeric_limits<double>::infinity();  ///< of (F / scale)^p for the last p, where all V > 0
  double least_volume = 0;                               ///< min V where it is not
  double least_gain = 0;  ///< relative, of the norm or of min V in units of a background tet's

  Bar(const OneRing& ring, double h, double gain);
  bool tangled() const { return sum == std::numeric_limits<double>::infinity(); }
  bool passed(const OneRing& ring, const Vec3& y) const;
  bool passed(double sum_there) const { return sum_there < sum * (1 - least_gain); }
};

struct Displacement {
  Vec3 y;
  double sum;  ///< Bar::sum there; not a number for a bar that is tangled

  bool passed(const OneRing& ring, const Bar& bar) const {
    return bar.tangled() ? bar.passed(ring, y) : bar.passed(sum);
  }
};

/// The best displacement of a vertex that may step in these directions; as good as the ring can be had in one solve.
Displacement best_displacement(const OneRing& ring, const Bar& bar, double h, const Directions& directions);

/// The tets of the ring with 1/F, in the sign of V, below `good_f` at 0 or at y.
std::bitset<kMaxRing> tets_below_target(const OneRing& ring, const Vec3& y, double good_f);

struct PowerSum {
  double sum = 0;                ///< infinite where some V <= 0
  Vec3 gradient = Vec3::Zero();  ///< of ln(sum) / p
  Mat3 hessian = Mat3::Zero();   ///< of ln(sum) / p
};

/// sum_j (F_j(y) / scale)^p over a ring, p = 2^log2_p, and the derivatives of its ln / p: what the Newton steps are
/// made of. \throw std::invalid_argument for a log2_p that is not among the steps
PowerSum power_sum(const OneRing& ring, const Vec3& y, int log2_p, double scale);

}  // namespace umtet::detail
