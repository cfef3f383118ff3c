#pragma once

#include "mesh/core/implicit_function.h"

namespace umtet {

/// Magnitudes of the two principal curvatures of {psi = 0} at x, the larger first; units 1 / length.
/// \pre psi.has_hessian(), grad psi(x) is not 0
Eigen::Vector2d principal_curvatures(ImplicitFunctionRef psi, const Vec3& x);

/// The largest edge length at which flat faces deviate by at most `deviation` from a surface with these principal
/// curvatures.
///
/// The centroid of a triangle with corners on a surface is off it by R^2 (k1 + k2) / 4 for circumradius R. With R = .77
/// h, a bound for the faces of a mesh, this is (|k1| + |k2|) h^2 / 6.8. Curvatures above 1 / deviation are replaced by
/// this value: such a bump is no larger than the permitted deviation.
/// @return infinity if the surface is flat, or if the curvatures are not numbers
double edge_of_deviation(const Eigen::Vector2d& curvatures, double deviation);

/// The turning angle of {psi = 0} along a mesh edge of length `h` with midpoint x: the angle, in radians, between the
/// normals at the edge's ends, in the direction in which it is largest.
///
/// The chord between the normals is taken as linear in the direction, and two directions are evaluated. A surface of
/// curvature k turns by k h, a sharp edge at once. For ripples finer than h, the slope determines the angle and not the
/// curvature.
/// @param x  on {psi = 0}  @param n  the unit normal there
/// Cost: eight gradients of psi
double turn_along(ImplicitFunctionRef psi, const Vec3& x, const Vec3& n, double h);

}  // namespace umtet
