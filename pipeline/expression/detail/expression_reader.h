#pragma once

#include <ginac/ginac.h>

#include <array>
#include <optional>
#include <string>

namespace umtet {

/// A formula as GiNaC holds it; all its numbers are exact fractions.
struct SymbolicExpression {
  GiNaC::ex psi;
  std::array<GiNaC::realsymbol, 3> symbols;  ///< x, y, z
};

/// Reads the grammar that pipeline/expression/expression.h describes.
/// @param t  the fraction that the shortest decimal number for this double is; without it there is no name t
/// \throw ExpressionError
SymbolicExpression read_expression(const std::string& text, std::optional<double> t = std::nullopt);

}  // namespace umtet
