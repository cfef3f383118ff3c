#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"

namespace umtet::testing {

/// A domain known in closed form: psi with exact derivatives and what the tests may hold a mesh of it against.
struct AnalyticDomain {
  std::string name;
  Box box;  ///< holds the closure of the domain and none of psi's spurious sheets
  int components = 1;
  int genus = 0;                     ///< summed over the components of the boundary
  std::optional<double> volume;      ///< where a closed form is known
  std::vector<Vec3> boundary_seeds;  ///< a point near every component of the boundary
  std::function<double(const Vec3&, Vec3*, Mat3*)> psi;

  double value(const Vec3& x) const { return psi(x, nullptr, nullptr); }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    psi(x, &g, nullptr);
    return g;
  }
  Mat3 hessian(const Vec3& x) const {
    Vec3 g;
    Mat3 H;
    psi(x, &g, &H);
    return H;
  }
  double evaluate(const Vec3& x, Vec3* g, Mat3* H) const { return psi(x, g, H); }
};

inline Box cube_box(double half) { return Box(Vec3::Constant(-half), Vec3::Constant(half)); }

/// psi = |x|^2 - 1.
inline AnalyticDomain sphere() {
  return {"sphere", cube_box(1.1), 1, 0, 4 * std::numbers::pi / 3, {{1, 0, 0}}, [](const Vec3& x, Vec3* g, Mat3* H) {
            if (g) *g = 2 * x;
            if (H) *H = 2 * Mat3::Identity();
            return x.squaredNorm() - 1;
          }};
}

/// psi = sum (x_i / a_i)^2 - 1.
inline AnalyticDomain ellipsoid(const Vec3& a = {1, .8, .6}) {
  const Vec3 w = a.array().square().inverse();
  return {"ellipsoid",
          Box(-1.1 * a, 1.1 * a),
          1,
          0,
          4 * std::numbers::pi / 3 * a.prod(),
          {{a.x(), 0, 0}},
          [w](const Vec3& x, Vec3* g, Mat3* H) {
            if (g) *g = 2 * w.cwiseProduct(x);
            if (H) *H = (2 * w).asDiagonal();
            return w.dot(x.cwiseProduct(x)) - 1;
          }};
}

/// psi = (sqrt(x^2 + y^2) - R)^2 + z^2 - r^2; not smooth on the z axis, which is far from the boundary.
inline AnalyticDomain torus(double R = 1, double r = .4) {
  const double reach = R + r + .1;
  return {"torus",
          Box(Vec3(-reach, -reach, -r - .1), Vec3(reach, reach, r + .1)),
          1,
          1,
          2 * std::numbers::pi * std::numbers::pi * R * r * r,
          {{R + r, 0, 0}},
          [R, r](const Vec3& x, Vec3* g, Mat3* H) {
            const double rho = std::hypot(x.x(), x.y());
            const double s = rho > 0 ? R / rho : 0;
            if (g) *g = 2 * Vec3(x.x() * (1 - s), x.y() * (1 - s), x.z());
            if (H) {
              const double s3 = rho > 0 ? s / (rho * rho) : 0;
              *H = Mat3::Zero();
              (*H)(0, 0) = 2 * (1 - s + s3 * x.x() * x.x());
              (*H)(1, 1) = 2 * (1 - s + s3 * x.y() * x.y());
              (*H)(0, 1) = (*H)(1, 0) = 2 * s3 * x.x() * x.y();
              (*H)(2, 2) = 2;
            }
            return (rho - R) * (rho - R) + x.z() * x.z() - r * r;
          }};
}

/// Eq. (9) of [Rangarajan2018], genus 2. Its zero set is unbounded: a looser box picks up spurious sheets.
inline AnalyticDomain equation_9() {
  return {"equation_9",
          Box(Vec3(-2.1, -2.1, -1.05), Vec3(2.1, 2.1, 1.05)),
          1,
          2,
          std::nullopt,
          {{0, 0, 1}},
          [](const Vec3& p, Vec3* g, Mat3* H) {
            const double x = p.x(), y = p.y(), z2 = p.z() * p.z(), w = 1 - z2, s = x * x + y * y;
            const double c = 2 * y * (y * y - 3 * x * x);
            const double cx = -12 * x * y, cy = 6 * (y * y - x * x), cz = 2 * p.z() * (18 * z2 - 10 - c);
            if (g) *g = Vec3(cx * w + 4 * x * s, cy * w + 4 * y * s, cz);
            if (H) {
              const double xy = -12 * x * w + 8 * x * y, xz = -2 * p.z() * cx, yz = -2 * p.z() * cy;
              *H << -12 * y * w + 4 * s + 8 * x * x, xy, xz, xy, 12 * y * w + 4 * s + 8 * y * y, yz, xz, yz,
                  108 * z2 - 20 - 2 * c;
            }
            return c * w + s * s - (9 * z2 - 1) * w;
          }};
}

/// Eq. (13) of [Rangarajan2018]: sum (x_i^2 + sin(t x_i)) - 1. One component at t = 0 (the unit sphere), four at 3.2.
inline AnalyticDomain equation_13(double t) {
  AnalyticDomain domain{"equation_13", cube_box(2.1), 1, 0, std::nullopt, {}, [t](const Vec3& x, Vec3* g, Mat3* H) {
                          const Eigen::Array3d s = (t * x.array()).sin(), c = (t * x.array()).cos();
                          if (g) *g = 2 * x.array() + t * c;
                          if (H) *H = (2 - t * t * s).matrix().asDiagonal();
                          return x.squaredNorm() + s.sum() - 1;
                        }};
  if (t == 3.2) {
    // Along each axis x^2 + sin(3.2 x) has minima near -.42 and 1.2. The big component joins the places with at most
    // one coordinate at the second; the small ones have two there.
    domain.components = 4;
    domain.boundary_seeds = {{-.42, -.42, -.42}, {1.2, 1.2, -.42}, {1.2, -.42, 1.2}, {-.42, 1.2, 1.2}};
  }
  return domain;
}

/// Banchoff-Chmutov surface T_4(x) + T_4(y) + T_4(z) = 0, genus 5.
inline AnalyticDomain banchoff_chmutov_4() {
  return {"banchoff_chmutov_4", cube_box(1.15), 1, 5, std::nullopt, {{1, 0, .55}}, [](const Vec3& x, Vec3* g, Mat3* H) {
            const Eigen::Array3d a = x.array(), a2 = a.square();
            if (g) *g = 32 * a2 * a - 16 * a;
            if (H) *H = (96 * a2 - 16).matrix().asDiagonal();
            return (8 * a2.square() - 8 * a2 + 1).sum();
          }};
}

/// The family over which the laws of the mesher are stated.
inline std::vector<AnalyticDomain> domains() {
  return {sphere(), ellipsoid(), torus(), equation_9(), equation_13(3.2), banchoff_chmutov_4()};
}

}  // namespace umtet::testing
