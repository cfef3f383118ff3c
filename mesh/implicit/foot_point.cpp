#include "mesh/implicit/foot_point.h"

#include <cmath>

namespace umtet {
namespace {

/// Damped Newton along the gradient: from y to a point with |psi| <= tol |grad psi|. `y` and `g` are updated.
bool reach_zero_set(ImplicitFunctionRef psi, double step_cap, double tol, Vec3& y, Vec3& g) {
  double value = psi.value(y, g);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double slope2 = g.squaredNorm();
    if (!std::isfinite(value) || !(slope2 > 0) || !std::isfinite(slope2)) return false;
    const double slope = std::sqrt(slope2);
    if (std::abs(value) <= tol * slope) return true;
    Vec3 step = -value / slope2 * g;
    if (const double length = step.norm(); length > step_cap) step *= step_cap / length;
    Vec3 next_g;
    double next = psi.value(y + step, next_g);
    for (int halving = 0; halving < 20 && !(std::abs(next) < std::abs(value)); ++halving) {
      step *= 0.5;
      next = psi.value(y + step, next_g);
    }
    if (!(std::abs(next) < std::abs(value))) return false;
    y += step;
    value = next;
    g = next_g;
  }
  return false;
}

}  // namespace

Foot foot_point(ImplicitFunctionRef psi, const Vec3& x, double h) {
  Foot foot;
  Vec3 y = x, g;
  const double tol = 1e-12 * h;
  if (!reach_zero_set(psi, 0.5 * h, tol, y, g)) return foot;
  double distance = (y - x).norm();
  double relaxation = 1;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Vec3 w = g.normalized();
    const Vec3 slide = (x - y) - w.dot(x - y) * w;
    // The distance is second order in what is left of the slide, the normal first order.
    if (slide.norm() <= 1e-4 * distance + tol) break;
    Vec3 next = y + relaxation * slide, next_g;
    if (reach_zero_set(psi, 0.5 * h, tol, next, next_g) && (next - x).norm() < distance) {
      y = next;
      g = next_g;
      distance = (y - x).norm();
    } else if ((relaxation *= 0.5) < 1e-3) {
      break;
    }
  }
  foot.found = true;
  foot.distance = distance;
  foot.point = y;
  foot.normal = g.normalized();
  return foot;
}

}  // namespace umtet
