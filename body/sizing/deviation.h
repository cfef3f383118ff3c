#pragma once

#include "body/body.h"
#include "common/context.h"

namespace umtet {

/// Returns the largest edge length for which flat faces stay within `deviation` of psi = 0, according to its curvature:
/// the minimum of edge_of_deviation().
///
/// The detail of psi depends on h: h decreases from `start` until it suffices for the psi with the detail for h. On
/// return, domain has the detail for the result.
/// @param deviation, start  model units, > 0
/// @return at most `start`; `least` if the deviation requires a smaller h
/// \throw Cancelled
double h_for_deviation(Domain& domain, double deviation, double start, double least, const Context& context = {});

}  // namespace umtet
