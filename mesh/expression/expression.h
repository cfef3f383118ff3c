#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "common/vec3.h"
#include "mesh/expression/tape.h"

namespace umtet {

/// The text is not an expression that the program can differentiate. what() contains the column and a caret under the
/// error.
struct ExpressionError : std::runtime_error {
  ExpressionError(const std::string& text, std::size_t column, const std::string& message);
  std::size_t column;  ///< 1-based; text.size() + 1 when something is missing at the end
};

/// psi, given as text in x, y, z; Omega = {psi < 0}. A JointlyEvaluated implicit function.
///
/// A family of functions contains t in its text; each member is a separate Expression in which t is a number.
///
/// Grammar: + - * / ^ ( ), numbers, x y z pi, and sin cos tan asin acos atan sinh cosh tanh exp log sqrt of one
/// argument. ^ binds to the right and before a sign: -x^2 = -(x^2), 2^3^2 = 2^9, 2^-1 = .5. There is no abs, because
/// psi must be C2.
///
/// The text becomes a tape of operations, executed in the order in which the text gives them; gradient and Hessian
/// follow by the chain rule. Parsing the same text again gives the same function to the last bit. Thread-safe.
/// The result is NaN where the formula has no real value (log of a negative number).
class Expression {
 public:
  /// \throw ExpressionError  the text does not follow the grammar, a number or power is out of range, a constant has no
  ///   real value, or nothing depends on x, y or z
  /// @param t  finite; without it, the name t is unknown
  explicit Expression(std::string text, std::optional<double> t = std::nullopt);

  const std::string& text() const { return text_; }
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  /// Returns the value, and stores gradient and Hessian if the pointers are not null.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const { return tape_.evaluate(x, gradient, hessian); }

 private:
  std::string text_;
  Tape tape_;
};

}  // namespace umtet
