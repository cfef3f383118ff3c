#include "python/function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace umtet::python {
namespace py = pybind11;
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Central differences err by step^2 and by eps / step: least at the cube root of eps; second ones at the fourth root.
constexpr double kStep = 6e-6, kWideStep = 1.2e-4;

/// Appends the numbers of a result.
void read_numbers(const py::handle& result, std::size_t size, const char* what, std::vector<double>& out) {
  const Array a = Array::ensure(result);
  if (!a || result.is_none()) {  // numpy makes a NaN of None
    PyErr_Clear();
    throw std::invalid_argument(std::string("psi: its ") + what + " are not an array of numbers");
  }
  if (static_cast<std::size_t>(a.size()) != size) {
    throw std::invalid_argument(std::string("psi: its ") + what + " are " + std::to_string(a.size()) +
                                " numbers, not " + std::to_string(size) + ": it is called with points (n, 3)");
  }
  out.insert(out.end(), a.data(), a.data() + size);
}

/// Makes new arrays, because the callable may keep them.
Array array_of(std::span<const Vec3> x) {
  Array points({static_cast<py::ssize_t>(x.size()), py::ssize_t{3}});
  double* p = points.mutable_data();
  for (const Vec3& at : x) p = std::copy_n(at.data(), 3, p);
  return points;
}
Array array_of(const Vec3& x) { return Array(py::ssize_t{3}, x.data()); }

/// The number of derivatives in a result: 0 to 2.
int order_of(const py::object& result) {
  const int order = py::isinstance<py::tuple>(result) ? static_cast<int>(py::len(result)) - 1 : 0;
  if (order < 0 || order > 2) throw std::invalid_argument("psi must return an array, or a tuple of 1 to 3 arrays");
  return order;
}

int wanted_of(const Question& question) { return question.hessian ? 2 : question.gradient ? 1 : 0; }

// Points of the differences. If there are values only: the centre; six neighbours for the gradient; six wider ones and
// twelve on the diagonals for the Hessian. If there are gradients: the centre and six neighbours.
constexpr std::array<std::size_t, 3> kPointsByValues = {1, 7, 25};
constexpr std::size_t kPointsByGradients = 7;
constexpr std::array<std::pair<int, int>, 3> kPairs = {{{0, 1}, {0, 2}, {1, 2}}};

}  // namespace

struct Function::Answer {
  std::vector<double> values, gradients, hessians;
};

Function::Function(py::object callable, const Vec3& probe, double length)
    : callable_(std::move(callable)), step_(kStep * length), wide_step_(kWideStep * length) {
  try {
    try_at(probe);
  } catch (py::error_already_set& e) {
    if (!e.matches(PyExc_Exception) || !takes_points(probe)) throw;
  } catch (const std::invalid_argument&) {
    if (!takes_points(probe)) throw;
  }
  fibers_ = std::make_unique<Fibers>([this](std::span<Question* const> questions) { answer(questions); });
}

/// Evaluates at two points, because a callable for one point (3,) does not return two values for them.
void Function::try_at(const Vec3& x) {
  const std::array<Vec3, 2> points = {x, x + Vec3::Constant(step_)};
  order_ = order_of(callable_(takes_blocks_ ? array_of(points) : array_of(x)));
  call(points, order_);
}

bool Function::takes_points(const Vec3& x) {
  takes_blocks_ = false;
  try {
    try_at(x);
  } catch (const std::exception&) {
    return false;  // the user gets the message about the block
  }
  return true;
}

Function::Answer Function::call(std::span<const Vec3> x, int wanted) const {
  Answer answer;
  const auto ask = [&](const Array& points, std::size_t n) {
    const py::object result = callable_(points);
    if (order_ != order_of(result)) throw std::invalid_argument("psi: it returns different numbers of arrays");
    if (!py::isinstance<py::tuple>(result)) return read_numbers(result, n, "values", answer.values);
    const auto parts = py::reinterpret_borrow<py::tuple>(result);
    read_numbers(parts[0], n, "values", answer.values);
    if (wanted > 0) read_numbers(parts[1], 3 * n, "gradients", answer.gradients);
    if (wanted > 1) read_numbers(parts[2], 9 * n, "Hessians", answer.hessians);
  };
  if (takes_blocks_) {
    ask(array_of(x), x.size());
  } else {
    for (const Vec3& at : x) ask(array_of(at), 1);
  }
  return answer;
}

double Function::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  Question question{x, 0, gradient, hessian};
  if (fibers_->is_inside()) {
    fibers_->ask(question);
  } else {
    answer(std::array{&question});
  }
  return question.value;
}

void Function::values(std::span<const Vec3> x, double* out) const {
  const py::gil_scoped_acquire gil;
  const Answer answer = call(x, 0);
  std::copy(answer.values.begin(), answer.values.end(), out);
}

/// Answers all questions with one call.
void Function::answer(std::span<Question* const> questions) const {
  std::vector<Vec3> points;
  std::vector<std::size_t> first;
  int wanted = 0;
  for (const Question* question : questions) {
    first.push_back(points.size());
    add_points(*question, points);
    wanted = std::max(wanted, wanted_of(*question));
  }
  const py::gil_scoped_acquire gil;
  const Answer answer = call(points, std::min(wanted, order_));
  for (std::size_t k = 0; k < questions.size(); ++k) read(answer, points, first[k], *questions[k]);
}

void Function::add_points(const Question& question, std::vector<Vec3>& points) const {
  const int wanted = wanted_of(question);
  const std::size_t n = wanted <= order_ ? 1 : order_ == 1 ? kPointsByGradients : kPointsByValues[wanted];
  points.resize(points.size() + n, question.x);
  Vec3* const at = points.data() + points.size() - n;
  if (n == 1) return;
  for (int i = 0; i < 3; ++i) {
    at[1 + i][i] += step_;
    at[4 + i][i] -= step_;
  }
  if (n < kPointsByValues[2]) return;
  for (int i = 0; i < 3; ++i) {
    at[7 + i][i] += wide_step_;
    at[10 + i][i] -= wide_step_;
    for (int k = 0; k < 4; ++k) {
      at[13 + 4 * i + k][kPairs[i].first] += k & 1 ? wide_step_ : -wide_step_;
      at[13 + 4 * i + k][kPairs[i].second] += k & 2 ? wide_step_ : -wide_step_;
    }
  }
}

/// @param first  the question's first point
void Function::read(const Answer& answer, std::span<const Vec3> points, std::size_t first, Question& question) const {
  const double* const f = answer.values.data() + first;
  const Vec3* const at = points.data() + first;
  question.value = *f;
  Vec3* const gradient = question.gradient;
  Mat3* const hessian = question.hessian;
  if (gradient && order_ > 0) *gradient = Eigen::Map<const Vec3>(answer.gradients.data() + 3 * first);
  if (gradient && order_ == 0) {
    for (int i = 0; i < 3; ++i) (*gradient)[i] = (f[1 + i] - f[4 + i]) / (at[1 + i][i] - at[4 + i][i]);
  }
  if (!hessian) return;
  if (order_ == 2) {
    *hessian = Eigen::Map<const Mat3>(answer.hessians.data() + 9 * first);
  } else if (order_ == 1) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 7>> g(answer.gradients.data() + 3 * first);
    Mat3 H;
    for (int i = 0; i < 3; ++i) H.col(i) = (g.col(1 + i) - g.col(4 + i)) / (at[1 + i][i] - at[4 + i][i]);
    *hessian = (H + H.transpose()) / 2;
  } else {
    const double w = wide_step_;
    for (int i = 0; i < 3; ++i) {
      const auto [a, b] = kPairs[i];
      const double* mixed = f + 13 + 4 * i;
      (*hessian)(i, i) = (f[7 + i] - 2 * f[0] + f[10 + i]) / (w * w);
      (*hessian)(a, b) = (*hessian)(b, a) = (mixed[0] - mixed[1] - mixed[2] + mixed[3]) / (4 * w * w);
    }
  }
}

}  // namespace umtet::python
