#include "mesh/implicit/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace umtet {
namespace {

// Newton's 2x2 matrix I + mu H is indefinite where y is no local minimum of the distance. Its eigenvalues are replaced
// by their magnitudes, at least this: the step stays a descent direction and of sensible length near a centre of
// curvature.
constexpr double kLeastStiffness = .1;
// Where a step does not shrink the residual to this share, it was too long if the slide has changed its direction, and
// too short if not.
constexpr double kContraction = .5;
// Steps along the surface, in lengths: farther off, the second-order model of psi does not hold.
constexpr double kMaxSlide = .5;
constexpr double kLeastDamping = 1. / 64;
constexpr double kRecovery = 1.5;
// Over-relaxation of Damped where the foot creeps: its rate is 1 - omega (1 - curvature * distance).
constexpr double kMostRelaxation = 8;
// Evaluations of the line search, in max_iterations.
constexpr int kDescentEvaluations = 10;

/// psi at an iterate, in the frame of its normal.
struct IterateFoot {
  double step = 0;  ///< psi / |grad psi|: the distance to the boundary, to first order
  double norm = 0;  ///< |grad psi|
  Vec3 w;           ///< grad psi / |grad psi|
  Vec3 slide;       ///< (I - w w^T)(x - y): the part of x - y along the surface
  bool usable = false;
};

inline IterateFoot foot_at(double value, const Vec3& gradient, const Vec3& to_x) {
  IterateFoot f;
  f.norm = gradient.norm();
  f.usable = f.norm > 0 && std::isfinite(f.norm) && std::isfinite(value);
  if (!f.usable) return f;
  f.w = gradient / f.norm;
  f.step = value / f.norm;
  f.slide = to_x - to_x.dot(f.w) * f.w;
  return f;
}

ClosestPoint paper(ImplicitFunctionRef psi, const Vec3& x, double length, const ClosestPointParams& params) {
  ClosestPoint result{x};
  Vec3 gradient;
  while (result.iterations < params.max_iterations) {
    const double value = psi.value(result.point, gradient);
    ++result.iterations;
    const IterateFoot f = foot_at(value, gradient, x - result.point);
    if (!f.usable) return result;
    const double t = result.t - f.step;  // 3.8(a)(ii): J = grad psi . w = |grad psi|
    const Vec3 next = x + t * f.w;
    if (std::abs(f.step) <= params.tol * length && (next - result.point).norm() <= params.foot_tol * length) {
      result.converged = true;
      return result;
    }
    result.t = t;
    result.point = next;
  }
  return result;
}

/// The step z along the surface from E^T (I + mu H) E z = E^T r, E an orthonormal basis of the tangent plane and r the
/// residual at y plus what the normal step -step w adds to it.
Vec3 newton_slide(const IterateFoot& f, const Mat3& hessian, const Vec3& to_x) {
  const double mu = to_x.dot(f.w) / f.norm;  // least squares for y - x + mu grad psi = 0
  const Vec3 e1 = f.w.unitOrthogonal(), e2 = f.w.cross(e1);
  const Vec3 He1 = hessian * e1, He2 = hessian * e2;
  const double a = 1 + mu * e1.dot(He1), b = mu * e1.dot(He2), d = 1 + mu * e2.dot(He2);
  const double r1 = f.slide.dot(e1) + mu * f.step * f.w.dot(He1);
  const double r2 = f.slide.dot(e2) + mu * f.step * f.w.dot(He2);
  const double mean = .5 * (a + d), half = .5 * (a - d), radius = std::sqrt(half * half + b * b);
  const double low = mean - radius, high = mean + radius;
  if (low > kLeastStiffness) {
    const double det = low * high;
    return ((d * r1 - b * r2) / det) * e1 + ((a * r2 - b * r1) / det) * e2;
  }
  // The matrix acts on r as mean +- radius on r's parts along its two eigenvectors; radius = 0 makes any pair one.
  const double c = radius > 0 ? half / radius : 1, s = radius > 0 ? b / radius : 0;
  const double along1 = .5 * (r1 + c * r1 + s * r2), along2 = .5 * (r2 + s * r1 - c * r2);  // projected on high's
  const double high_by = std::max(std::abs(high), kLeastStiffness), low_by = std::max(std::abs(low), kLeastStiffness);
  return (along1 / high_by + (r1 - along1) / low_by) * e1 + (along2 / high_by + (r2 - along2) / low_by) * e2;
}

ClosestPoint damped_or_newton(ImplicitFunctionRef psi, const Vec3& x, double length, const ClosestPointParams& params) {
  ClosestPoint result{x};
  const bool newton = params.method == ClosestPointMethod::Newton && psi.has_hessian();
  double omega = 1, last_residual = std::numeric_limits<double>::infinity();
  Vec3 last_slide = Vec3::Zero();
  Vec3 gradient;
  Mat3 hessian;
  while (result.iterations < params.max_iterations) {
    const double value = newton ? psi.value(result.point, gradient, hessian) : psi.value(result.point, gradient);
    ++result.iterations;
    const Vec3 to_x = x - result.point;
    const IterateFoot f = foot_at(value, gradient, to_x);
    if (!f.usable) return result;
    result.t = -to_x.dot(f.w);
    const double slide_norm = f.slide.norm();
    if (std::abs(f.step) <= params.tol * length && slide_norm <= params.foot_tol * length) {
      result.converged = to_x.norm() <= params.max_distance * length;
      return result;
    }
    const double residual = std::abs(f.step) + slide_norm;
    // At x itself there is no slide, so the first residual says nothing about the second.
    if (result.iterations > 2) {
      const bool shrinks = residual <= kContraction * last_residual;
      if (!shrinks && f.slide.dot(last_slide) < 0) {
        omega = std::max(.5 * omega, kLeastDamping);  // oscillates
      } else if (!shrinks || omega < 1) {
        omega = std::min(kRecovery * omega, newton ? 1. : kMostRelaxation);  // creeps, or may be a full step again
      }
    }
    last_slide = f.slide;
    last_residual = residual;
    Vec3 slide = omega * (newton ? newton_slide(f, hessian, to_x) : f.slide);
    const double far = slide.norm() / (kMaxSlide * length);
    if (far > 1) slide /= far;
    result.point += slide - std::clamp(f.step, -length, length) * f.w;
  }
  return result;
}

/// Normal steps from y until psi vanishes to `tol`; false when they do not arrive.
bool land(ImplicitFunctionRef psi, double tol, double length, Vec3& y, int& evaluations) {
  Vec3 gradient;
  for (int it = 0; it < 30; ++it) {
    const double value = psi.value(y, gradient);
    ++evaluations;
    const IterateFoot f = foot_at(value, gradient, Vec3::Zero());
    if (!f.usable) return false;
    if (std::abs(f.step) <= tol * length) return true;
    y -= std::clamp(f.step, -length, length) * f.w;
  }
  return false;
}

/// Minimises |x - y|^2 over the surface with a line search: every foot accepted lies on psi = 0 and is nearer to x than
/// the one before, so this settles where the iterations above oscillate or creep (curvature times distance near 1). It
/// takes about ten times the evaluations and is seldom needed.
ClosestPoint descend(ImplicitFunctionRef psi, const Vec3& x, double length, const ClosestPointParams& params) {
  ClosestPoint result{x};
  const bool newton = params.method == ClosestPointMethod::Newton && psi.has_hessian();
  if (!land(psi, params.tol, length, result.point, result.iterations)) return result;
  Vec3 gradient;
  Mat3 hessian;
  while (result.iterations < kDescentEvaluations * params.max_iterations) {
    const Vec3 to_x = x - result.point;
    const double value = newton ? psi.value(result.point, gradient, hessian) : psi.value(result.point, gradient);
    ++result.iterations;
    const IterateFoot f = foot_at(value, gradient, to_x);
    if (!f.usable) return result;
    result.t = -to_x.dot(f.w);
    if (f.slide.norm() <= params.foot_tol * length) {
      result.converged = to_x.norm() <= params.max_distance * length;
      return result;
    }
    const Vec3 z = newton ? newton_slide(f, hessian, to_x) : f.slide;
    double step = std::min(1., kMaxSlide * length / z.norm());
    bool moved = false;
    for (; step > 1e-6 && !moved; step /= 2) {
      Vec3 trial = result.point + step * z;
      if (!land(psi, params.tol, length, trial, result.iterations)) continue;
      // Armijo's condition with a small constant: the surface bends, so less is gained than in the tangent plane.
      moved = (x - trial).squaredNorm() <= to_x.squaredNorm() * (1 + 1e-15) - 1e-4 * step * f.slide.dot(z);
      if (moved) result.point = trial;
    }
    if (!moved) return result;
  }
  return result;
}

}  // namespace

std::vector<std::string> problems(const ClosestPointParams& params) {
  std::vector<std::string> list;
  const auto positive = [&](double value, const char* name) {
    if (!(value > 0)) list.push_back(std::string(name) + " = " + std::to_string(value) + ": must be > 0");
  };
  if (params.max_iterations < 1) {
    list.push_back("max_iterations = " + std::to_string(params.max_iterations) + ": must be >= 1");
  }
  positive(params.tol, "tol");
  positive(params.foot_tol, "foot_tol");
  positive(params.max_distance, "max_distance");
  return list;
}

ClosestPoint closest_point(ImplicitFunctionRef psi, const Vec3& x, double length, const ClosestPointParams& params) {
  if (params.method != ClosestPointMethod::Paper) {
    ClosestPoint quick = damped_or_newton(psi, x, length, params);
    if (quick.converged) return quick;
    ClosestPoint slow = descend(psi, x, length, params);
    slow.iterations += quick.iterations;
    return slow;
  }
  ClosestPoint result = paper(psi, x, length, params);
  if ((result.point - x).norm() > params.max_distance * length) result.converged = false;
  return result;
}

}  // namespace umtet
