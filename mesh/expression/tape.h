#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// The operations of a tape. a and b are results of earlier operations; c is a number.
enum class Operator : std::uint8_t {
  // The coordinates of the point.
  X,
  Y,
  Z,
  // Operations on a and b.
  Add,
  Subtract,
  Multiply,
  Divide,
  Power,
  // Operations on a and c: a + c, c - a, a c, a / c, c / a, a^c, c^a.
  AddNumber,
  SubtractFrom,
  MultiplyBy,
  DivideBy,
  DivideNumber,
  ToNumber,
  NumberTo,
  // Operations on a.
  Square,
  Sin,
  Cos,
  Tan,
  Asin,
  Acos,
  Atan,
  Sinh,
  Cosh,
  Tanh,
  Exp,
  Log,
  Sqrt,
};

struct Operation {
  Operator kind;
  int a = -1, b = -1;  ///< indices of operations; -1: none
  double c = 0;
  bool operator==(const Operation&) const = default;
};

/// A function of x, y, z as a list of operations; the last one gives its value.
///
/// Derivatives come from the same list by the chain rule, in forward mode: every operation has a value, a gradient and
/// a Hessian [Griewank2008, chapters 3 and 13]. The arithmetic does not depend on
/// which of them are requested.
struct Tape {
  std::vector<Operation> operations;

  /// Returns the value, and stores gradient and Hessian if the pointers are not null. The result is NaN where the
  /// function has no real value. Thread-safe.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
};

/// Returns f(a), or f(a, b), of numbers.
double apply(Operator f, double a, double b = 0, double c = 0);

}  // namespace umtet
