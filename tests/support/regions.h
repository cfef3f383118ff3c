#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/vec3.h"
#include "mesh/core/piecewise_domain.h"

namespace umtet::testing {

/// |x - c|^2 - r^2.
inline PatchFunction ball(const Vec3& c, double r) {
  return [c, r](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    if (gradient) *gradient = 2 * (x - c);
    if (hessian) *hessian = 2 * Mat3::Identity();
    return (x - c).squaredNorm() - r * r;
  };
}

/// 0 everywhere: what surrounds bodies that are negative inside.
inline PatchFunction zero() {
  return [](const Vec3&, Vec3* gradient, Mat3* hessian) {
    if (gradient) gradient->setZero();
    if (hessian) hessian->setZero();
    return 0.;
  };
}

/// f plus the linear function a . x.
inline PatchFunction tilted(PatchFunction f, const Vec3& a) {
  return [f = std::move(f), a](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    const double value = f(x, gradient, hessian);
    if (gradient) *gradient += a;
    return value + a.dot(x);
  };
}

/// A torus around the z axis, as a polynomial of degree 4.
inline PatchFunction torus(double R, double r) {
  return [R, r](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    const double k = x.squaredNorm() + R * R - r * r;
    const Vec3 flat(x[0], x[1], 0);
    if (gradient) *gradient = 4 * k * x - 8 * R * R * flat;
    if (hessian) {
      *hessian = 8 * x * x.transpose() + 4 * k * Mat3::Identity();
      (*hessian)(0, 0) -= 8 * R * R;
      (*hessian)(1, 1) -= 8 * R * R;
    }
    return k * k - 4 * R * R * flat.squaredNorm();
  };
}

/// f in coordinates that are rotated and then shifted.
inline PatchFunction placed(PatchFunction f, const Mat3& R, const Vec3& shift) {
  return [f = std::move(f), R, shift](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    const double value = f(R.transpose() * (x - shift), gradient, hessian);
    if (gradient) *gradient = R * *gradient;
    if (hessian) *hessian = R * *hessian * R.transpose();
    return value;
  };
}

}  // namespace umtet::testing
