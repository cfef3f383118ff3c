#pragma once

#include "common/context.h"
#include "pipeline/domain/domain.h"

namespace umtet {

/// The two principal curvatures of {psi = 0} at x, in magnitude, the larger first; units 1 / length.
/// \pre psi.has_hessian(), grad psi(x) is not 0
Eigen::Vector2d principal_curvatures(ImplicitFunctionRef psi, const Vec3& x);

/// The largest edge length at which flat faces stay within `deviation` of psi = 0, by its curvature.
///
/// The centroid of a triangle with its corners on a surface is off it by R^2 (k1 + k2) / 4 for circumradius R. With
/// R = .77 h, a bound for the faces of a mesh, that is (|k1| + |k2|) h^2 / 6.8. Curvatures above 1 / deviation count as
/// that: such a bump is no larger than what may be missed. psi is taken as it is cut for the h that results: h is
/// lowered from `start` until it is fine enough for the detail that it lets in. On return domain is cut for the result.
/// @param deviation, start  model units, > 0
/// @return at most `start`; not above start, and `least` where even that is too coarse
/// \throw Cancelled
double h_for_deviation(Domain& domain, double deviation, double start, double least, const Context& context = {});

}  // namespace umtet
