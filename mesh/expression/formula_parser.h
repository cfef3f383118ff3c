#pragma once

#include <optional>
#include <string>

#include "mesh/expression/tape.h"

namespace umtet {

/// Parses the grammar that mesh/expression/expression.h describes. Equal parts of a formula are one operation, and
/// parts without x, y, z are numbers.
/// @param t  without it, the name t is unknown
/// \throw ExpressionError
Tape parse_formula(const std::string& text, std::optional<double> t = std::nullopt);

}  // namespace umtet
