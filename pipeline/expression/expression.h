#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/vec3.h"

namespace umtet {

/// The text is not an expression this program can differentiate. what() has the column and a caret under the place.
struct ExpressionError : std::runtime_error {
  ExpressionError(const std::string& text, std::size_t column, const std::string& message);
  std::size_t column;  ///< 1-based; text.size() + 1 when something is missing at the end
};

/// psi given as text in x, y, z; Omega = {psi < 0}. A JointlyEvaluated implicit function.
///
/// A family of them has t in its text; each member is an Expression of its own, in which t is a number.
///
/// Grammar: + - * / ^ ( ), numbers, x y z pi, and sin cos tan asin acos atan sinh cosh tanh exp log sqrt of one
/// argument. ^ binds to the right and before a sign: -x^2 = -(x^2), 2^3^2 = 2^9, 2^-1 = .5. There is no abs: psi must
/// be C2.
///
/// muParser reads the text, GiNaC differentiates it exactly (decimal numbers are kept as fractions), muParser evaluates
/// psi, its gradient and its Hessian. Each reading of a text is the same function to the last bit. Thread-safe: every
/// thread gets its own evaluators at its first call.
/// Where the formula has no real value (log of a negative number) the result is NaN.
/// Licence: GiNaC is GPL-2+, so a program that links this file is GPL as a whole.
class Expression {
 public:
  /// \throw ExpressionError  not in the grammar, a number or power out of range, a pole or an imaginary number among
  ///                         the constants, or nothing that depends on x, y or z
  /// @param t  finite; read as the shortest decimal number for it: .1 is a tenth. Without it there is no name t
  explicit Expression(const std::string& text, std::optional<double> t = std::nullopt);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  const std::string& text() const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  /// value; gradient and Hessian where the pointers are not null
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace umtet
