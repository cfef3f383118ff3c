#include "mesh/features/formula_domain.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mesh/expression/expression.h"
#include "mesh/expression/formula_parser.h"

namespace umtet {
namespace {

/// A smooth part as f or -f, so that both have one zero set.
struct SignedTape {
  Tape tape;
  bool is_negative;
};
SignedTape signed_tape(Tape tape) {
  const Operation last = tape.operations.back();
  const bool is_negative = last.kind == Operator::SubtractFrom && last.c == 0;
  if (is_negative) tape.operations.pop_back();  // all others are what it is the negative of
  return {std::move(tape), is_negative};
}

}  // namespace

PiecewiseDomain domain_of_formula(const std::string& text, std::optional<double> t) {
  PiecewiseFormula formula = parse_piecewise_formula(text, t);
  std::vector<Tape> tapes;
  std::vector<PiecewiseDomain> patches, parts;
  for (const Tape& tape : formula.tapes) {
    const SignedTape s = signed_tape(tape);
    const auto same = std::find_if(tapes.begin(), tapes.end(),
                                   [&](const Tape& other) { return other.operations == s.tape.operations; });
    const auto k = static_cast<std::size_t>(same - tapes.begin());
    if (same == tapes.end()) {
      tapes.push_back(s.tape);
      patches.emplace_back(
          [f = s.tape](const Vec3& x, Vec3* gradient, Mat3* hessian) { return f.evaluate(x, gradient, hessian); });
    }
    parts.push_back(s.is_negative ? complement(patches[k]) : patches[k]);
  }
  std::vector<PiecewiseDomain> made;
  try {
    for (const PiecewiseFormula::Node& node : formula.nodes) {
      if (node.is_leaf) {
        made.push_back(parts[static_cast<std::size_t>(node.tape)]);
        continue;
      }
      const PiecewiseDomain &a = made[static_cast<std::size_t>(node.left)],
                            &b = made[static_cast<std::size_t>(node.right)];
      made.push_back(node.is_max ? intersection(a, b) : united(a, b));
    }
  } catch (const std::invalid_argument&) {
    throw ExpressionError(text, 1, "one part bounds the body from both of its sides, as f in max(f, -f)");
  }
  return made.back();
}

}  // namespace umtet
