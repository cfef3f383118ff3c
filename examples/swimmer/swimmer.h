#pragma once

#include "mesh/core/implicit_function.h"

namespace umtet {

/// The swimmer of [Rangarajan2018, Section 4.3] at one time: its shape and how its surface moves.
///
///     phi_t(r, z) = 1 - 2/pi arctan A - 2/pi arctan B,      r^2 = x^2 + y^2,                                eq. (14)
///     A = r^2 / 2 + z^2 / 64 - 1,      B = r^2 + (z - t)^2 - 25/4 cos^2(pi t / 16),
///
/// moved by z0 along the axis. The surface is A B = 1 with A, B > 0: a spheroid of half axes sqrt 2 and 8, and a ball
/// at z = t, of radius 5/2 at t = 0 and none at t = -8 and 8, with a smooth union. One stroke: -8 <= t <= 8.
///
/// @note phi_t as printed is positive inside, so omega_t is {phi_t >= 0}, not the sublevel set of the text; the paper's
///       velocity, eq. (15), is the same for phi and -phi. psi = -phi here, negative inside.
class Swimmer {
 public:
  Swimmer(double t, double z0) : t_(t), z0_(z0) {}

  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  /// d psi / dt for a body at rest, with z0 fixed.
  double time_derivative(const Vec3& x) const;

  /// v_t(x - z0 e_z) = -(d psi / dt) grad psi / |grad psi|^2, eq. (15): the velocity of the surface without its
  /// translation.
  /// \pre x is near the surface, where the gradient does not vanish
  Vec3 deformation_velocity(const Vec3& x) const;

  double time() const { return t_; }
  double position() const { return z0_; }

 private:
  double t_, z0_;
};

}  // namespace umtet
