#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mesh/core/implicit_function.h"
#include "python/fibers.h"

namespace umtet::python {

/// psi as a Python callable: f(points (n, 3)) -> values (n,), or (values, gradients (n, 3)), or (values, gradients,
/// Hessians (n, 3, 3)). Derivatives that it does not return are computed by central differences. It is called in blocks
/// of some hundred points for derivatives and of some thousand points for values.
///
/// A callable that raises an exception for a block, or returns another number of values, is called with single points
/// (3,).
///
/// Every call acquires the GIL, so calls of several threads wait for each other.
class Function final : private SideBySide {
 public:
  /// Calls the callable once or twice, near `probe`, to determine its arguments and results.
  /// @param length  size of the domain, > 0: steps of differences are 6e-6 of it, 1.2e-4 for Hessians from values
  /// \throw std::invalid_argument for other shapes; exceptions of the callable
  Function(pybind11::object callable, const Vec3& probe, double length);

  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  void values(std::span<const Vec3> x, double* out) const;
  /// Null for a callable with single points.
  const SideBySide* side_by_side() const { return takes_blocks_ ? this : nullptr; }

 private:
  struct Answer;
  void for_each(std::size_t n, const std::function<void(std::size_t)>& f) const override { fibers_->for_each(n, f); }
  void try_at(const Vec3& x);
  bool takes_points(const Vec3& x);
  Answer call(std::span<const Vec3> x, int wanted) const;
  void answer(std::span<Question* const> questions) const;
  void add_points(const Question& question, std::vector<Vec3>& points) const;
  void read(const Answer& answer, std::span<const Vec3> points, std::size_t first, Question& question) const;

  pybind11::object callable_;
  bool takes_blocks_ = true;
  int order_ = 0;  ///< order of the derivatives that it returns
  double step_, wide_step_;
  std::unique_ptr<Fibers> fibers_;
};

}  // namespace umtet::python
