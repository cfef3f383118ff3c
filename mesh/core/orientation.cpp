#include "mesh/core/orientation.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace umtet {
namespace {

using Integer = boost::multiprecision::cpp_int;

/// value = mantissa * 2^exponent with an integer mantissa below 2^53.
struct Dyadic {
  std::int64_t mantissa;
  int exponent;
};

Dyadic dyadic(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return {static_cast<std::int64_t>(std::ldexp(fraction, 53)), exponent - 53};
}

/// The same determinant without rounding: all coordinates are scaled by one power of two to integers.
int exact_sign(const Vec3* const (&p)[4]) {
  Dyadic x[4][3];
  int least = std::numeric_limits<int>::max();
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) {
      x[i][k] = dyadic((*p[i])[k]);
      if (x[i][k].mantissa != 0) least = std::min(least, x[i][k].exponent);
    }
  }
  Integer r[4][3];
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) {
      r[i][k] = x[i][k].mantissa;
      if (x[i][k].mantissa != 0) r[i][k] <<= x[i][k].exponent - least;
      if (i > 0) r[i][k] -= r[0][k];
    }
  }
  const Integer det = r[1][0] * (r[2][1] * r[3][2] - r[2][2] * r[3][1]) -
                      r[1][1] * (r[2][0] * r[3][2] - r[2][2] * r[3][0]) +
                      r[1][2] * (r[2][0] * r[3][1] - r[2][1] * r[3][0]);
  return det.sign();
}

}  // namespace

int orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double p[6] = {v.y() * w.z(), v.z() * w.y(), v.z() * w.x(), v.x() * w.z(), v.x() * w.y(), v.y() * w.x()};
  const double det = u.x() * (p[0] - p[1]) + u.y() * (p[2] - p[3]) + u.z() * (p[4] - p[5]);
  const double permanent = std::abs(u.x()) * (std::abs(p[0]) + std::abs(p[1])) +
                           std::abs(u.y()) * (std::abs(p[2]) + std::abs(p[3])) +
                           std::abs(u.z()) * (std::abs(p[4]) + std::abs(p[5]));
  // |det - exact| <= (7 + 56 eps) eps permanent with eps = 2^-53 [Shewchuk1997, orient3d, stage A]; we allow 8 eps.
  // A fused multiply-add rounds once where the proof rounds twice, so the bound holds with and without it. The proof
  // excludes underflow: for differences below 1e100 it adds at most 12 * 2^-1075 * 1e100 < eps * 1e-200.
  const double largest = std::max({u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff(), w.cwiseAbs().maxCoeff()});
  if (largest < kFilterGreatest && permanent > kFilterLeast) {
    if (det > kFilterBound * permanent) return 1;
    if (det < -kFilterBound * permanent) return -1;
  }
  if (!a.allFinite() || !b.allFinite() || !c.allFinite() || !d.allFinite()) return 0;
  for (int k = 0; k < 3; ++k) {
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k]) return 0;  // on the flat wall of a box
  }
  return exact_sign({&a, &b, &c, &d});
}

}  // namespace umtet
