#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "mesh/core/implicit_function.h"

namespace umtet::python {

/// psi as a Python callable: f(points (n, 3)) -> values (n,), or (values, gradients (n, 3)), or (values, gradients,
/// Hessians (n, 3, 3)). What it does not return is made of central differences, all points of them in one call.
///
/// The GIL is taken in every call, so that calls of several threads wait for each other.
class Function {
 public:
  /// Calls it once, at `probe`, to see what it returns.
  /// @param length  of the domain, > 0: steps of differences are 6e-6 of it, 1.2e-4 for Hessians made of values
  /// \throw std::invalid_argument  not of these shapes; what the callable raises
  Function(pybind11::object callable, const Vec3& probe, double length);

  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

 private:
  struct Answer;
  Answer call(const Vec3* x, pybind11::ssize_t n) const;
  double by_gradients(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double by_values(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  pybind11::object callable_;
  int order_ = 0;  ///< of the derivatives that it returns
  double step_, wide_step_;
};

}  // namespace umtet::python
