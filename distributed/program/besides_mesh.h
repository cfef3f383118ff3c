#pragma once

#include "body/body.h"

namespace umtet {

/// Estimated memory in bytes of a domain on the rank that runs the program, besides its local mesh: samples, levels of
/// psi that h does not resolve, the components of psi = 0, and the boundary on which it measures what other ranks do
/// not.
/// @param domain  limited to the resolution of h
double bytes_besides_mesh(const Domain& domain, double h);

}  // namespace umtet
