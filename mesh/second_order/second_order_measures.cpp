#include "mesh/second_order/second_order_measures.h"

#include <algorithm>
#include <cmath>

#include "mesh/implicit/closest_point.h"

namespace umtet {
namespace {

constexpr double kSmall = .01;  // of h: slope and closest point agree to a few per cent of it

/// The distance by the slope, but where it is not small against h that to a closest point: what psi's slope says is off
/// then by its curvature, and without bounds where the gradient nearly vanishes.
double far_distance(ImplicitFunctionRef psi, const Vec3& x, double h) {
  const double d = slope_distance(psi, x);
  if (d <= kSmall * h) return d;
  const ClosestPoint foot = closest_point(psi, x, h, {});
  return foot.converged ? (foot.point - x).norm() : d;
}

}  // namespace

void JacobianMeasure::add(const JacobianBounds& b) {
  volume += b.mean / 6;
  n_nonpositive += !b.positive();
  lower = std::min(lower, b.scaled_lower());
  upper = std::min(upper, b.mean > 0 ? b.upper / b.mean : -1);
}

void JacobianMeasure::add(const JacobianMeasure& next) {
  volume += next.volume;
  n_nonpositive += next.n_nonpositive;
  lower = std::min(lower, next.lower);
  upper = std::min(upper, next.upper);
}

double slope_distance(ImplicitFunctionRef psi, const Vec3& x) {
  Vec3 g;
  const double value = psi.value(x, g);
  const double d = value == 0 ? 0 : std::abs(value) / g.norm();
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

std::array<double, 4> curved_face_distances(ImplicitFunctionRef psi, const std::array<Vec3, 6>& x, double h) {
  std::array<double, 4> d{};
  for (std::size_t s = 0; s < 4; ++s) {
    Vec3 l = Vec3::Constant(s == 3 ? 1. / 3 : 1. / 6);
    if (s < 3) l[static_cast<int>(s)] = 2. / 3;
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < 3; ++k) place += l[k] * (2 * l[k] - 1) * x[k] + 4 * l[k] * l[(k + 1) % 3] * x[3 + k];
    d[s] = far_distance(psi, place, h);
  }
  return d;
}

}  // namespace umtet
