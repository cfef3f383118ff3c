#include "mesh/expression/tape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace umtet {
namespace {

/// A value and its derivatives up to an order: v; x y z; xx xy xz yy yz zz.
template <int order>
using Jet = std::array<double, order == 0   ? 1
                               : order == 1 ? 4
                                            : 10>;

/// f(x) of one operand, and its derivatives up to the order.
struct Derivatives {
  double f, first = 0, second = 0;
};

/// The derivatives of f = x^c. Products instead of powers would lose digits at large c.
template <int order>
Derivatives number_power(double x, double c) {
  Derivatives d{std::pow(x, c)};
  if constexpr (order > 0) d.first = c * std::pow(x, c - 1);
  if constexpr (order > 1) d.second = c * (c - 1) * std::pow(x, c - 2);
  return d;
}

template <int order>
Derivatives of_one(const Operation& o, double x) {
  const double c = o.c;
  switch (o.kind) {
    case Operator::AddNumber:
      return {x + c, 1};
    case Operator::SubtractFrom:
      return {c - x, -1};
    case Operator::MultiplyBy:
      return {x * c, c};
    case Operator::DivideBy:
      return {x / c, 1 / c};
    case Operator::DivideNumber:
      return {c / x, -c / (x * x), 2 * c / (x * x * x)};
    case Operator::ToNumber:
      return number_power<order>(x, c);
    case Operator::NumberTo: {
      const double f = std::pow(c, x), log_c = order > 0 ? std::log(c) : 0;
      return {f, f * log_c, f * log_c * log_c};
    }
    case Operator::Square:
      return {x * x, 2 * x, 2};
    case Operator::Sin: {
      const double f = std::sin(x);
      return {f, order > 0 ? std::cos(x) : 0, -f};
    }
    case Operator::Cos: {
      const double f = std::cos(x);
      return {f, order > 0 ? -std::sin(x) : 0, -f};
    }
    case Operator::Tan: {
      const double f = std::tan(x);
      return {f, 1 + f * f, 2 * f * (1 + f * f)};
    }
    case Operator::Asin: {
      const double r = 1 - x * x, s = order > 0 ? std::sqrt(r) : 1;
      return {std::asin(x), 1 / s, x / (r * s)};
    }
    case Operator::Acos: {
      const double r = 1 - x * x, s = order > 0 ? std::sqrt(r) : 1;
      return {std::acos(x), -1 / s, -x / (r * s)};
    }
    case Operator::Atan: {
      const double first = 1 / (1 + x * x);
      return {std::atan(x), first, -2 * x * first * first};
    }
    case Operator::Sinh: {
      const double f = std::sinh(x);
      return {f, order > 0 ? std::cosh(x) : 0, f};
    }
    case Operator::Cosh: {
      const double f = std::cosh(x);
      return {f, order > 0 ? std::sinh(x) : 0, f};
    }
    case Operator::Tanh: {
      const double f = std::tanh(x);
      return {f, 1 - f * f, -2 * f * (1 - f * f)};
    }
    case Operator::Exp: {
      const double f = std::exp(x);
      return {f, f, f};
    }
    case Operator::Log:
      return {std::log(x), 1 / x, -1 / (x * x)};
    default: {
      const double f = std::sqrt(x);
      return {f, .5 / f, -.25 / (f * x)};
    }
  }
}

/// The first derivatives that belong to the second derivatives of a jet, which begin at kSecond.
constexpr std::size_t kSecond = 4;
constexpr std::array<std::size_t, 6> kRow{1, 1, 1, 2, 2, 3}, kColumn{1, 2, 3, 2, 3, 3};

template <int order>
Jet<order> chain(const Derivatives& d, const Jet<order>& a) {
  Jet<order> f{d.f};
  for (std::size_t k = 1; k < f.size(); ++k) f[k] = d.first * a[k];
  if constexpr (order > 1) {
    for (std::size_t k = 0; k < kRow.size(); ++k) {
      const std::size_t i = kRow[k], j = kColumn[k], m = kSecond + k;
      f[m] += d.second * (a[i] * a[j]);
    }
  }
  return f;
}

template <int order>
Jet<order> product(const Jet<order>& a, const Jet<order>& b) {
  Jet<order> f{a[0] * b[0]};
  for (std::size_t k = 1; k < f.size(); ++k) f[k] = a[0] * b[k] + b[0] * a[k];
  if constexpr (order > 1) {
    for (std::size_t k = 0; k < kRow.size(); ++k) {
      const std::size_t i = kRow[k], j = kColumn[k], m = kSecond + k;
      f[m] += a[i] * b[j] + a[j] * b[i];
    }
  }
  return f;
}

template <int order>
Jet<order> quotient(const Jet<order>& a, const Jet<order>& b) {
  Jet<order> f{a[0] / b[0]};
  for (std::size_t k = 1; k < std::min(kSecond, f.size()); ++k) f[k] = (a[k] - f[0] * b[k]) / b[0];
  if constexpr (order > 1) {
    for (std::size_t k = 0; k < kRow.size(); ++k) {
      const std::size_t i = kRow[k], j = kColumn[k], m = kSecond + k;
      f[m] = (a[m] - f[0] * b[m] - (f[i] * b[j] + f[j] * b[i])) / b[0];
    }
  }
  return f;
}

/// a^b where both depend on the point: the derivatives of a at constant b, and those of exp(b log a).
template <int order>
Jet<order> power(const Jet<order>& a, const Jet<order>& b) {
  const Derivatives by_a = number_power<order>(a[0], b[0]);
  Jet<order> f = chain<order>(by_a, a);
  if constexpr (order > 0) {
    const double log_a = std::log(a[0]);
    for (std::size_t k = 1; k < f.size(); ++k) f[k] += by_a.f * log_a * b[k];
    if constexpr (order > 1) {
      const double f_ab = std::pow(a[0], b[0] - 1) * (1 + b[0] * log_a), f_bb = by_a.f * log_a * log_a;
      for (std::size_t k = 0; k < kRow.size(); ++k) {
        const std::size_t i = kRow[k], j = kColumn[k], m = kSecond + k;
        f[m] += f_ab * (a[i] * b[j] + a[j] * b[i]) + f_bb * (b[i] * b[j]);
      }
    }
  }
  return f;
}

template <int order>
Jet<order> sum(const Jet<order>& a, const Jet<order>& b, double sign) {
  Jet<order> f;
  for (std::size_t k = 0; k < f.size(); ++k) f[k] = a[k] + sign * b[k];
  return f;
}

template <int order>
const Jet<order>& run(const std::vector<Operation>& operations, const Vec3& x) {
  thread_local std::vector<Jet<order>> jets;
  if (jets.size() < operations.size()) jets.resize(operations.size());
  for (std::size_t n = 0; n < operations.size(); ++n) {
    const Operation& o = operations[n];
    const auto a = [&]() -> const Jet<order>& { return jets[static_cast<std::size_t>(o.a)]; };
    const auto b = [&]() -> const Jet<order>& { return jets[static_cast<std::size_t>(o.b)]; };
    switch (o.kind) {
      case Operator::X:
      case Operator::Y:
      case Operator::Z: {
        const auto i = static_cast<std::size_t>(o.kind);
        jets[n] = {x[static_cast<Eigen::Index>(i)]};
        if constexpr (order > 0) jets[n][1 + i] = 1;
        break;
      }
      case Operator::Add:
        jets[n] = sum<order>(a(), b(), 1);
        break;
      case Operator::Subtract:
        jets[n] = sum<order>(a(), b(), -1);
        break;
      case Operator::Multiply:
        jets[n] = product<order>(a(), b());
        break;
      case Operator::Divide:
        jets[n] = quotient<order>(a(), b());
        break;
      case Operator::Power:
        jets[n] = power<order>(a(), b());
        break;
      default:
        jets[n] = chain<order>(of_one<order>(o, a()[0]), a());
    }
  }
  return jets[operations.size() - 1];
}

}  // namespace

double Tape::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  if (!gradient && !hessian) return run<0>(operations, x)[0];
  if (!hessian) {
    const Jet<1>& f = run<1>(operations, x);
    *gradient = {f[1], f[2], f[3]};
    return f[0];
  }
  const Jet<2>& f = run<2>(operations, x);
  if (gradient) *gradient = {f[1], f[2], f[3]};
  *hessian << f[4], f[5], f[6], f[5], f[7], f[8], f[6], f[8], f[9];
  return f[0];
}

double apply(Operator f, double a, double b, double c) {
  const std::vector<Operation> operations{{Operator::X}, {Operator::Y}, {f, 0, 1, c}};
  return run<0>(operations, {a, b, 0})[0];
}

}  // namespace umtet
