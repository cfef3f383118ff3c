#include "python/function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace umtet::python {
namespace py = pybind11;
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Central differences err by step^2 and by eps / step: least at the cube root of eps; second ones at the fourth root.
constexpr double kStep = 6e-6, kWideStep = 1.2e-4;

Array array_of(const py::handle& result, py::ssize_t size, const char* what) {
  Array a = Array::ensure(result);
  if (!a || result.is_none()) {  // numpy makes a NaN of None
    PyErr_Clear();
    throw std::invalid_argument(std::string("psi: its ") + what + " are no array of numbers");
  }
  if (a.size() != size) {
    throw std::invalid_argument(std::string("psi: its ") + what + " are " + std::to_string(a.size()) +
                                " numbers, not " + std::to_string(size) + ": it is called with points (n, 3)");
  }
  return a;
}

}  // namespace

struct Function::Answer {
  Array values;
  std::optional<Array> gradients, hessians;
};

Function::Function(py::object callable, const Vec3& probe, double length)
    : callable_(std::move(callable)), step_(kStep * length), wide_step_(kWideStep * length) {
  Array point({py::ssize_t{1}, py::ssize_t{3}});
  std::copy_n(probe.data(), 3, point.mutable_data());
  const py::object result = callable_(point);
  if (py::isinstance<py::tuple>(result)) {
    order_ = static_cast<int>(py::len(result)) - 1;
    if (order_ < 0 || order_ > 2) throw std::invalid_argument("psi: a tuple of 1 to 3 arrays is wanted");
  }
  call(&probe, 1);
}

Function::Answer Function::call(const Vec3* x, py::ssize_t n) const {
  Array points({n, py::ssize_t{3}});  // a new one: the callable may keep it
  double* p = points.mutable_data();
  for (py::ssize_t k = 0; k < n; ++k) p = std::copy_n(x[k].data(), 3, p);
  const py::object result = callable_(points);
  const bool is_tuple = py::isinstance<py::tuple>(result);
  if (order_ != (is_tuple ? static_cast<int>(py::len(result)) - 1 : 0)) {
    throw std::invalid_argument("psi: it returns now more arrays, now fewer");
  }
  if (!is_tuple) return {array_of(result, n, "values"), std::nullopt, std::nullopt};
  const auto parts = py::reinterpret_borrow<py::tuple>(result);
  Answer answer{array_of(parts[0], n, "values"), std::nullopt, std::nullopt};
  if (order_ > 0) answer.gradients = array_of(parts[1], 3 * n, "gradients");
  if (order_ > 1) answer.hessians = array_of(parts[2], 9 * n, "Hessians");
  return answer;
}

double Function::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const py::gil_scoped_acquire gil;
  const int wanted = hessian ? 2 : gradient ? 1 : 0;
  if (wanted > order_) return order_ == 1 ? by_gradients(x, gradient, hessian) : by_values(x, gradient, hessian);
  const Answer answer = call(&x, 1);
  if (gradient) *gradient = Eigen::Map<const Vec3>(answer.gradients->data());
  if (hessian) *hessian = Eigen::Map<const Mat3>(answer.hessians->data());
  return *answer.values.data();
}

double Function::by_gradients(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  std::array<Vec3, 7> points;
  points.fill(x);
  for (int i = 0; i < 3; ++i) {
    points[1 + i][i] += step_;
    points[4 + i][i] -= step_;
  }
  const Answer answer = call(points.data(), 7);
  const Eigen::Map<const Eigen::Matrix<double, 3, 7>> g(answer.gradients->data());
  if (gradient) *gradient = g.col(0);
  Mat3 H;
  for (int i = 0; i < 3; ++i) H.col(i) = (g.col(1 + i) - g.col(4 + i)) / (points[1 + i][i] - points[4 + i][i]);
  *hessian = (H + H.transpose()) / 2;
  return *answer.values.data();
}

double Function::by_values(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  // The centre, six neighbours for the gradient; six wider ones and twelve on the diagonals for the Hessian.
  constexpr std::array<std::pair<int, int>, 3> kPairs = {{{0, 1}, {0, 2}, {1, 2}}};
  std::array<Vec3, 25> points;
  points.fill(x);
  const double d = step_, w = wide_step_;
  for (int i = 0; i < 3; ++i) {
    points[1 + i][i] += d;
    points[4 + i][i] -= d;
    points[7 + i][i] += w;
    points[10 + i][i] -= w;
    for (int k = 0; k < 4; ++k) {
      points[13 + 4 * i + k][kPairs[i].first] += k & 1 ? w : -w;
      points[13 + 4 * i + k][kPairs[i].second] += k & 2 ? w : -w;
    }
  }
  const Answer answer = call(points.data(), hessian ? 25 : 7);
  const double* f = answer.values.data();
  if (gradient) {
    for (int i = 0; i < 3; ++i) (*gradient)[i] = (f[1 + i] - f[4 + i]) / (points[1 + i][i] - points[4 + i][i]);
  }
  if (hessian) {
    for (int i = 0; i < 3; ++i) {
      const auto [a, b] = kPairs[i];
      const double* mixed = f + 13 + 4 * i;
      (*hessian)(i, i) = (f[7 + i] - 2 * f[0] + f[10 + i]) / (w * w);
      (*hessian)(a, b) = (*hessian)(b, a) = (mixed[0] - mixed[1] - mixed[2] + mixed[3]) / (4 * w * w);
    }
  }
  return f[0];
}

}  // namespace umtet::python
