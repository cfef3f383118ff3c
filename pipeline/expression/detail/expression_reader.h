#pragma once

#include <ginac/ginac.h>

#include <array>
#include <optional>
#include <string>

namespace umtet {

/// A formula in GiNaC; all its numbers are exact fractions.
struct SymbolicExpression {
  GiNaC::ex psi;
  std::array<GiNaC::realsymbol, 3> symbols;  ///< x, y, z
};

/// Parses the grammar that pipeline/expression/expression.h describes.
/// @param t  converted to the fraction of its shortest decimal number; without it, the name t is unknown
/// \throw ExpressionError
SymbolicExpression read_expression(const std::string& text, std::optional<double> t = std::nullopt);

}  // namespace umtet
