#pragma once

#include "mesh/core/implicit_function.h"

namespace umtet {

/// The two principal curvatures of {psi = 0} at x, in magnitude, the larger first; units 1 / length.
/// \pre psi.has_hessian(), grad psi(x) is not 0
Eigen::Vector2d principal_curvatures(ImplicitFunctionRef psi, const Vec3& x);

/// The largest edge length at which flat faces stay within `deviation` of a surface of these principal curvatures.
///
/// The centroid of a triangle with its corners on a surface is off it by R^2 (k1 + k2) / 4 for circumradius R. With
/// R = .77 h, a bound for the faces of a mesh, that is (|k1| + |k2|) h^2 / 6.8. Curvatures above 1 / deviation count as
/// that: such a bump is no larger than what may be missed.
/// @return infinity where it is flat, or where the curvatures are no numbers
double edge_of_deviation(const Eigen::Vector2d& curvatures, double deviation);

/// The angle, in radians, between the normals of {psi = 0} where a mesh edge of length `h` with its middle at x has its
/// ends, in the direction in which it is largest: the chord between the normals is taken as linear in the direction,
/// and two of them are looked at. A surface of curvature k turns by k h, a sharp edge at once; of ripples finer than h
/// it is the slope that counts, and not their curvature.
/// @param x  on {psi = 0}  @param n  the unit normal there
/// Cost: eight gradients of psi
double turn_along(ImplicitFunctionRef psi, const Vec3& x, const Vec3& n, double h);

}  // namespace umtet
