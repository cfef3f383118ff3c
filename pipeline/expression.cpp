#include "pipeline/expression.h"

#include <fmt/format.h>
#include <muParser.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "pipeline/detail/derivative_size.h"
#include "pipeline/detail/expression_reader.h"

namespace umtet {
namespace {

// Of a second derivative: it grows with the cube of the number of factors, or of brackets within each other. So much
// takes half a second; what muParser still reads has some 1e4.
constexpr double kMaxDerivativeSize = 2e5;

std::string at_column(const std::string& text, std::size_t column, const std::string& message) {
  return "column " + std::to_string(column) + ": " + message + "\n  " + text + "\n  " + std::string(column - 1, ' ') +
         "^";
}

/// As muParser reads it: all numbers of `e` are exact fractions, so nothing is rounded in print. GiNaC keeps sums and
/// products in an order that depends on addresses: operands are sorted by their text, or rounding would differ from run
/// to run.
std::string print(const GiNaC::ex& e) {
  const bool sum = GiNaC::is_a<GiNaC::add>(e), power = GiNaC::is_a<GiNaC::power>(e);
  if (sum || power || GiNaC::is_a<GiNaC::mul>(e) || GiNaC::is_a<GiNaC::function>(e)) {
    std::vector<std::string> operands;
    for (std::size_t i = 0; i < e.nops(); ++i) operands.push_back(print(e.op(i)));
    const bool call = GiNaC::is_a<GiNaC::function>(e);
    if (!power && !call) std::sort(operands.begin(), operands.end());
    std::string text = call ? GiNaC::ex_to<GiNaC::function>(e).get_name() + "(" : "(";
    for (std::size_t i = 0; i < operands.size(); ++i) {
      if (i > 0) text += call ? "," : power ? "^" : sum ? "+" : "*";
      text += operands[i];
    }
    return text + ")";
  }
  std::ostringstream s;
  s.imbue(std::locale::classic());
  s << '(' << GiNaC::dflt << e << ')';
  return s.str();
}

/// psi alone, psi with gradient, and all ten: three byte codes over one set of variables.
class Evaluator {
 public:
  explicit Evaluator(const std::array<std::string, 3>& texts) {
    for (std::size_t k = 0; k < 3; ++k) {
      mu::Parser& p = parsers_[k];
      p.DefineConst("Pi", M_PI);
      p.DefineFun("log", static_cast<mu::fun_type1>(std::log), true);
      p.DefineVar("x", &x_[0]);
      p.DefineVar("y", &x_[1]);
      p.DefineVar("z", &x_[2]);
      p.SetExpr(texts[k]);
    }
  }
  Evaluator(const Evaluator&) = delete;  // the parsers hold the addresses of x_

  const double* operator()(std::size_t order, const Vec3& x) {
    x_ = {x[0], x[1], x[2]};
    int n = 0;
    return parsers_[order].Eval(n);
  }

 private:
  std::array<double, 3> x_{};
  std::array<mu::Parser, 3> parsers_;
};

}  // namespace

ExpressionError::ExpressionError(const std::string& text, std::size_t column, const std::string& message)
    : std::runtime_error(at_column(text, column, message)), column(column) {}

struct Expression::Impl {
  Impl(std::string formula, std::optional<double> t) : text(std::move(formula)) {
    const auto [psi, s] = read_expression(text, t);
    texts[0] = print(psi);
    if (const double size = second_derivative_size(psi); size > kMaxDerivativeSize) {
      throw ExpressionError(text, 1,
                            fmt::format("a second derivative would be some {:.2g} terms long, more than {:.0e}: "
                                        "fewer factors, powers or brackets within each other are needed",
                                        size, kMaxDerivativeSize));
    }
    try {
      texts[1] = texts[0];
      for (std::size_t i = 0; i < 3; ++i) texts[1].append(",").append(print(psi.diff(s[i])));
      texts[2] = texts[1];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = i; j < 3; ++j) texts[2].append(",").append(print(psi.diff(s[i]).diff(s[j])));
      }
    } catch (const std::exception& e) {  // GiNaC: 0^z has a value, and no derivative
      throw ExpressionError(text, 1, std::string("no derivative: ") + e.what());
    }
    try {
      for (const std::size_t order : {0, 1, 2}) evaluators.local()(order, Vec3::Zero());
    } catch (const mu::ParserError& e) {  // it reads its text at the first call
      throw ExpressionError(text, 1, "cannot be evaluated: " + e.GetMsg());
    }
  }

  std::string text;
  std::array<std::string, 3> texts;  ///< psi; psi and gradient; psi, gradient and xx xy xz yy yz zz
  mutable tbb::enumerable_thread_specific<Evaluator> evaluators{[this] { return Evaluator(texts); }};
};

Expression::Expression(const std::string& text, std::optional<double> t) : impl_(std::make_unique<Impl>(text, t)) {}
Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

const std::string& Expression::text() const { return impl_->text; }

double Expression::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const double* v = impl_->evaluators.local()(hessian ? 2 : gradient ? 1 : 0, x);
  if (gradient) *gradient = {v[1], v[2], v[3]};
  if (hessian) *hessian << v[4], v[5], v[6], v[5], v[7], v[8], v[6], v[8], v[9];
  return v[0];
}

}  // namespace umtet
