#include "pipeline/expression/expression.h"

#include <muParser.h>
#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/expression/detail/chain_rule.h"
#include "pipeline/expression/detail/expression_reader.h"

namespace umtet {
namespace {

// muParser refuses 20000 characters.
constexpr std::size_t kMaxText = 19000;

std::string at_column(const std::string& text, std::size_t column, const std::string& message) {
  return "column " + std::to_string(column) + ": " + message + "\n  " + text + "\n  " + std::string(column - 1, ' ') +
         "^";
}

/// psi with derivatives up to an order: several byte codes that use the same variables, executed one after the other.
class Evaluator {
 public:
  explicit Evaluator(const Assignments& assignments)
      : values_(assignments.texts.size()), results_(assignments.results.size()) {
    std::string text;
    const auto add = [&](const std::string& more) {
      if (!text.empty() && text.size() + 1 + more.size() > kMaxText) {
        parsers_.push_back(parser(text, assignments));
        text.clear();
      }
      text += (text.empty() ? "" : ",") + more;
    };
    for (const auto& [name, value] : assignments.texts) add(std::string(name).append("=").append(value));
    std::string results;
    for (const std::string& result : assignments.results) results += (result.empty() ? ",0" : "," + result);
    add(results.substr(1));
    parsers_.push_back(parser(text, assignments));
  }
  Evaluator(const Evaluator&) = delete;  // the parsers hold the addresses of x_ and values_

  /// \return psi and its derivatives
  const double* operator()(const Vec3& x) {
    x_ = {x[0], x[1], x[2]};
    int n = 0;
    const double* values = nullptr;
    for (const auto& p : parsers_) values = p->Eval(n);
    return values + n - results_;
  }

 private:
  std::unique_ptr<mu::Parser> parser(const std::string& text, const Assignments& assignments) {
    auto p = std::make_unique<mu::Parser>();
    p->DefineFun("log", static_cast<mu::fun_type1>(std::log), true);
    for (std::size_t i = 0; i < 3; ++i) p->DefineVar(std::string(1, "xyz"[i]), &x_[i]);
    for (std::size_t k = 0; k < values_.size(); ++k) p->DefineVar(assignments.texts[k].first, &values_[k]);
    for (const auto& [name, value] : assignments.constants) p->DefineConst(name, value);
    p->SetExpr(text);
    return p;
  }

  std::array<double, 3> x_{};
  std::vector<double> values_;
  std::size_t results_;
  std::vector<std::unique_ptr<mu::Parser>> parsers_;
};

using Evaluators = std::array<Evaluator, 3>;

}  // namespace

ExpressionError::ExpressionError(const std::string& text, std::size_t column, const std::string& message)
    : std::runtime_error(at_column(text, column, message)), column(column) {}

struct Expression::Impl {
  Impl(std::string formula, std::optional<double> t) : text(std::move(formula)) {
    const GiNaC::ex psi = read_expression(text, t).psi;
    try {
      for (const std::size_t order : {0, 1, 2}) assignments[order] = chain_rule(psi, static_cast<int>(order));
    } catch (const std::exception& e) {  // GiNaC: 0^z has a value but no derivative
      throw ExpressionError(text, 1, std::string("no derivative: ") + e.what());
    }
    try {
      for (const std::size_t order : {0, 1, 2}) evaluators.local()[order](Vec3::Zero());
    } catch (const mu::ParserError& e) {  // muParser parses its text at the first call
      throw ExpressionError(text, 1, "cannot be evaluated: " + e.GetMsg());
    }
  }

  std::string text;
  std::array<Assignments, 3> assignments;  ///< for psi; for psi and gradient; for psi, gradient and Hessian
  mutable tbb::enumerable_thread_specific<Evaluators> evaluators{[this] {
    return Evaluators{Evaluator(assignments[0]), Evaluator(assignments[1]), Evaluator(assignments[2])};
  }};
};

Expression::Expression(const std::string& text, std::optional<double> t) : impl_(std::make_unique<Impl>(text, t)) {}
Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

const std::string& Expression::text() const { return impl_->text; }

double Expression::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const double* v = impl_->evaluators.local()[hessian ? 2 : gradient ? 1 : 0](x);
  if (gradient) *gradient = {v[1], v[2], v[3]};
  if (hessian) *hessian << v[4], v[5], v[6], v[5], v[7], v[8], v[6], v[8], v[9];
  return v[0];
}

}  // namespace umtet
