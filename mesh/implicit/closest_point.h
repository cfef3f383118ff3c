#pragma once

#include <string>
#include <vector>

#include "mesh/core/implicit_function.h"

namespace umtet {

enum class ClosestPointMethod {
  Paper,   ///< the iteration of Section 3.8(a) to the letter; diverges where curvature times distance nears 1
  Damped,  ///< its normal step, with the step along the surface damped when the foot point stops settling
  Newton,  ///< on y - x + mu grad psi(y) = 0, psi(y) = 0, with safeguards; Damped if psi has no Hessian
};

struct ClosestPointParams {
  ClosestPointMethod method = ClosestPointMethod::Newton;
  int max_iterations = 60;   ///< evaluations of psi before the slower, surer way is taken (Paper: at most); >= 1
  double tol = 1e-10;        ///< stop needs |psi| / |grad psi| <= tol * length ...
  double foot_tol = 1e-7;    ///< ... and a next step along the surface of at most foot_tol * length
  double max_distance = 10;  ///< a foot farther than max_distance * length from x is not a closest point
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const ClosestPointParams&);

struct ClosestPoint {
  Vec3 point;              ///< pi(x), or the last iterate
  double t = 0;            ///< tends to -phi(x), minus the signed distance
  int iterations = 0;      ///< evaluations of psi and its derivatives
  bool converged = false;  ///< false: max_iterations used up, grad psi = 0 or not finite, foot too far
};

/// Closest point pi(x) on the boundary {psi = 0}                 [Rangarajan2018, eqs. (2), (4), Section 3.8(a)]
///
/// Paper:   w_k = grad psi(y_k) / |grad psi(y_k)|,  t_{k+1} = t_k - psi(y_k) / |grad psi(y_k)|,
///          y_{k+1} = x + t_{k+1} w_k  from t_0 = 0, y_0 = x.
/// Damped:  y_{k+1} = y_k - psi / |grad psi| w_k + omega (I - w_k w_k^T)(x - y_k). A fixed point of either iteration
/// has
///          x - y parallel to grad psi(y). omega falls when x - y swings to and fro along the surface, and grows when
///          it creeps.
/// Newton:  mu by least squares, the same normal step, and omega times the step along the surface from the 2 x 2 system
///          with I + mu Hess psi(y), which is positive definite exactly when y is a strict local minimum of the
///          distance. Elsewhere its eigenvalues are replaced by their magnitudes, which keeps the step downhill.
/// Steps along the surface are at most length / 2. Where Damped and Newton do not settle in max_iterations, the
/// distance is minimised over the surface with a line search, up to 10 max_iterations more.
///
/// @param psi     C2 near the boundary, negative inside.
/// @param x       same length unit as psi's domain; closer to the boundary than the local feature size, as positive
///                vertices are when the background mesh resolves the boundary.
/// @param length  what the tolerances are relative to, > 0; a background edge length, in model units.
/// @note t -> -phi(x). The paper's text says phi(x); its own eq. (4) gives the minus sign.
/// @note psi(y) vanishes faster than y settles (the foot point converges linearly), so a stop on |psi| alone leaves an
///       error of order sqrt(tol) along the surface; the paper's "either" would.
/// Cost: one value and one gradient (Newton: and one Hessian) per iteration. Does not allocate. Thread-safe if psi is.
ClosestPoint closest_point(ImplicitFunctionRef psi, const Vec3& x, double length, const ClosestPointParams& params);

}  // namespace umtet
