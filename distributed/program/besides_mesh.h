#pragma once

#include "body/body.h"

namespace umtet {

/// Returns the estimated memory in bytes that rank 0 needs in addition to its local mesh: for samples, levels of psi
/// that h does not resolve, the components of psi = 0, and the boundary of the whole mesh, which only rank 0 measures.
/// @param domain  domain with the detail for h
double bytes_besides_mesh(const Domain& domain, double h);

}  // namespace umtet
