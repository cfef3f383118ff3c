#pragma once

#include <ginac/ginac.h>

namespace umtet {

/// About how many symbols, numbers and functions a second derivative of e is written with: by the sum, product and chain
/// rules on numbers alone, in a time linear in e. The derivatives themselves may be too many to be made: of a product of
/// 370 factors they have fifty million, of 300 brackets within each other twenty.
double second_derivative_size(const GiNaC::ex& e);

}  // namespace umtet
