#pragma once

#include <string>
#include <vector>

#include "mesh/core/implicit_function.h"

namespace umtet {

/// Iteration of closest_point().
enum class ClosestPointMethod {
  Paper,   ///< the iteration of Section 3.8(a) to the letter; diverges where curvature times distance nears 1
  Damped,  ///< the normal step of Paper, with the step along the surface damped if the foot point does not settle
  Newton,  ///< Newton's method on y - x + mu grad psi(y) = 0, psi(y) = 0, with safeguards; Damped if psi has no Hessian
};

/// Parameters of closest_point().
struct ClosestPointParams {
  ClosestPointMethod method = ClosestPointMethod::Newton;
  int max_iterations = 60;   ///< evaluations of psi before a slower, safer method takes over (Paper: in all); >= 1
  double tol = 1e-10;        ///< stop criterion: |psi| / |grad psi| <= tol * length ...
  double foot_tol = 1e-7;    ///< ... and the next step along the surface is at most foot_tol * length
  double max_distance = 10;  ///< a foot point farther than max_distance * length from x is rejected
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const ClosestPointParams&);

/// Result of closest_point().
struct ClosestPoint {
  Vec3 point;              ///< pi(x), or the last iterate
  double t = 0;            ///< converges to -phi(x), minus the signed distance
  int iterations = 0;      ///< evaluations of psi and its derivatives
  bool converged = false;  ///< false: max_iterations used, grad psi = 0 or not finite, or the foot point is too far
};

/// Closest point pi(x) on the boundary {psi = 0}                 [Rangarajan2018, eqs. (2), (4), Section 3.8(a)]
///
/// Paper:   w_k = grad psi(y_k) / |grad psi(y_k)|,  t_{k+1} = t_k - psi(y_k) / |grad psi(y_k)|,
///          y_{k+1} = x + t_{k+1} w_k  from t_0 = 0, y_0 = x.
/// Damped:  y_{k+1} = y_k - psi / |grad psi| w_k + omega (I - w_k w_k^T)(x - y_k).
///          At a fixed point of either iteration, x - y is parallel to grad psi(y). omega decreases when x - y
///          oscillates along the surface, and increases when it creeps.
/// Newton:  mu by least squares, the same normal step, and omega times the step along the surface from the 2 x 2 system
///          with I + mu Hess psi(y). This matrix is positive definite exactly when y is a strict local minimum of the
///          distance. Otherwise its eigenvalues are replaced by their magnitudes, which keeps the step a descent step.
///
/// Steps along the surface are at most length / 2. If Damped or Newton does not converge in max_iterations, the
/// distance is minimised over the surface with a line search, in up to 10 max_iterations more.
///
/// @param psi     C2 near the boundary, negative inside.
/// @param x       same length unit as psi's domain; closer to the boundary than the local feature size, as positive
///                vertices are if the background mesh resolves the boundary.
/// @param length  reference length of the tolerances, > 0; a background edge length, in model units.
/// @note t -> -phi(x). The paper's text says phi(x); its own eq. (4) gives the minus sign.
/// @note psi(y) vanishes faster than y settles (the foot point converges linearly), so a stop on |psi| alone leaves an
///       error of order sqrt(tol) along the surface. The paper's "either" has this error.
/// Cost: one value and one gradient (Newton: and one Hessian) per iteration. Does not allocate. Thread-safe if psi is.
ClosestPoint closest_point(ImplicitFunctionRef psi, const Vec3& x, double length, const ClosestPointParams& params);

}  // namespace umtet
