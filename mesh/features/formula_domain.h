#pragma once

#include <optional>
#include <string>

#include "mesh/core/piecewise_domain.h"

namespace umtet {

/// The domain where a formula with max, min and abs is negative: max(x^2 + y^2 - 1, abs(z) - 1) is a cylinder with two
/// sharp curves. A formula without them is a domain of one patch.
/// \throw ExpressionError  as parse_piecewise_formula(); also if one smooth function bounds the domain from both of its
///                         sides, as f does in max(f, -f)
PiecewiseDomain domain_of_formula(const std::string& text, std::optional<double> t = std::nullopt);

}  // namespace umtet
