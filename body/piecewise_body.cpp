#include "body/piecewise_body.h"

#include <utility>

#include "mesh/expression/expression.h"
#include "mesh/features/formula_domain.h"

namespace umtet {

static_assert(JointlyEvaluated<Expression>);
static_assert(JointlyEvaluated<PiecewiseDomain>);

void set_body(Domain& domain, std::shared_ptr<const PiecewiseBody> body) {
  domain.formula = SharedFunction(std::shared_ptr<const PiecewiseDomain>(body, &body->domain));
  domain.piecewise = std::move(body);
}

void set_formula(Domain& domain, const std::string& text, std::optional<double> t) {
  try {
    domain.formula = shared_function(Expression(text, t));
    return;
  } catch (const ExpressionError&) {  // max, min or abs, or an error, which is found again
  }
  PiecewiseDomain pieces = domain_of_formula(text, t);
  if (pieces.n_patches() == 1) {
    domain.formula = shared_function(std::move(pieces));
  } else {
    set_body(domain, std::make_shared<const PiecewiseBody>(PiecewiseBody{std::move(pieces)}));
  }
}

}  // namespace umtet
