#pragma once

#include <ginac/ginac.h>

#include "pipeline/expression/detail/assignments.h"

namespace umtet {

/// Returns psi, in symbols named x, y, z, and its derivatives up to `order` (0, 1, 2) by the chain rule, one operation
/// F(u_0, u_1) after another:
///
///     F_i  = sum_k F_k u_k,i        F_ij = sum_k F_k u_k,ij + sum_kl F_kl u_k,i u_l,j
///
/// GiNaC computes F_k and F_kl. The text is at most some tens of times as long as psi; derivatives in closed form grow
/// with the cube of the number of factors, or of nested brackets. Common subexpressions are computed once.
///
/// \throw std::exception  from GiNaC, if there is no derivative (0^z)
Assignments chain_rule(const GiNaC::ex& psi, int order);

}  // namespace umtet
