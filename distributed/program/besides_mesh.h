#pragma once

#include "body/body.h"

namespace umtet {

/// About how many bytes the rank that runs the program holds of a domain, besides its part of the mesh: samples, levels
/// of psi that h does not show, the pieces of psi = 0, and the boundary on which it measures what others do not.
/// @param domain  cut for h
double bytes_besides_mesh(const Domain& domain, double h);

}  // namespace umtet
