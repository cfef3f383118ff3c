#pragma once

#include "body/body.h"
#include "common/context.h"

namespace umtet {

/// The largest edge length at which flat faces stay within `deviation` of psi = 0, by its curvature: the least
/// edge_of_deviation().
///
/// psi is taken as it is cut for the h that results: h is lowered from `start` until it is fine enough for the detail
/// that it lets in. On return domain is cut for the result.
/// @param deviation, start  model units, > 0
/// @return at most `start`; not above start, and `least` where even that is too coarse
/// \throw Cancelled
double h_for_deviation(Domain& domain, double deviation, double start, double least, const Context& context = {});

}  // namespace umtet
