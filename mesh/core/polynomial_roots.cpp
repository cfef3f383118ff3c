#include "mesh/core/polynomial_roots.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_poly.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>

namespace umtet {
namespace {

// Brent never needs more than the square of what bisection would, and in practice about eight steps.
constexpr int kMaxIterations = 100;
constexpr double kRelativeTolerance = 1e-15;

// GSL's default error handler aborts the process, which a library must not do; every return code is looked at instead.
void silence_gsl() {
  static const bool once = (gsl_set_error_handler_off(), true);
  static_cast<void>(once);
}

struct Polynomial {
  const double* c;
  int n;
};

double value(double s, void* polynomial) {
  const auto* p = static_cast<const Polynomial*>(polynomial);
  return gsl_poly_eval(p->c, p->n, s);
}

gsl_root_fsolver* brent() {
  thread_local const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), &gsl_root_fsolver_free);
  if (!solver) throw std::bad_alloc();
  return solver.get();
}

}  // namespace

double bracketed_root(std::span<const double> coefficients, double lo, double hi) {
  Polynomial p{coefficients.data(), static_cast<int>(coefficients.size())};
  const double at_lo = value(lo, &p), at_hi = value(hi, &p);
  const double nearer = std::abs(at_lo) <= std::abs(at_hi) ? lo : hi;
  if (!std::isfinite(at_lo) || !std::isfinite(at_hi) || (at_lo > 0) == (at_hi > 0) || at_lo == 0 || at_hi == 0) {
    return nearer;
  }
  silence_gsl();
  gsl_root_fsolver* solver = brent();
  gsl_function function{&value, &p};
  if (gsl_root_fsolver_set(solver, &function, lo, hi) != GSL_SUCCESS) return nearer;
  const double tolerance = kRelativeTolerance * std::max(std::abs(lo), std::abs(hi));
  for (int i = 0; i < kMaxIterations; ++i) {
    if (gsl_root_fsolver_iterate(solver) != GSL_SUCCESS) break;
    const int status =
        gsl_root_test_interval(gsl_root_fsolver_x_lower(solver), gsl_root_fsolver_x_upper(solver), tolerance, 0);
    if (status != GSL_CONTINUE) break;
  }
  return gsl_root_fsolver_root(solver);
}

}  // namespace umtet
