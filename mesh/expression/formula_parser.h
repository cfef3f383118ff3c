#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/expression/tape.h"

namespace umtet {

/// Parses the grammar that mesh/expression/expression.h describes. Equal parts of a formula are one operation, and
/// parts without x, y, z are numbers.
/// @param t  without it, the name t is unknown
/// \throw ExpressionError
Tape parse_formula(const std::string& text, std::optional<double> t = std::nullopt);

/// A formula with max, min and abs as max and min of smooth functions.
struct PiecewiseFormula {
  struct Node {
    bool is_leaf = true, is_max = false;
    int tape = -1;              ///< tape of a leaf
    int left = -1, right = -1;  ///< earlier nodes, otherwise
  };
  std::vector<Tape> tapes;  ///< no two of them are the same operations
  std::vector<Node> nodes;  ///< the last one is the root
};

/// As parse_formula(), with max(a, b, ...), min(a, b, ...) and abs(a) = max(a, -a).
///
/// They move outwards until all that is in them is smooth: c + max(a, b) = max(c + a, c + b), -max(a, b) =
/// min(-a, -b), max(a, b) + max(c, d) = max(a + c, a + d, b + c, b + d), and f(max(a, b)) = max(f(a), f(b)) for
/// asin, atan, sinh, tanh, exp, log and sqrt, which increase. They may be multiplied and divided by numbers.
/// \throw ExpressionError  also where they stand in another function, a product or a power, or make more than 256
///   smooth functions
PiecewiseFormula parse_piecewise_formula(const std::string& text, std::optional<double> t = std::nullopt);

}  // namespace umtet
