#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>

#include "reconstruct/lme_lattice.h"

namespace umtet::detail {

using LmeLanes = Eigen::Array<double, LmeBasis1d::kLanes, 1>;
using LmeLanesMap = Eigen::Map<const LmeLanes, Eigen::Aligned32>;

enum JetOrder { kValue = 0, kGradient = 1, kHessian = 2 };

/// f = sum c_a N_a and its derivatives with respect to x / h, up to the order asked for.
struct LatticeJet {
  double value = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

/// Contraction of the W^3 coefficients around a point over z, y, then x; eight lanes along x, of which those beyond the
/// support weigh nothing.
/// @param c  coefficients (double or float) of a lattice of n nodes, readable up to eight of them behind its end
template <int W, JetOrder order, class Coefficient>
LatticeJet contract(const LmeBasis3d& B, const Eigen::Vector3i& n, const Coefficient* c) {
  const std::ptrdiff_t nx = n[0], nxy = nx * n[1];
  const Coefficient* base = c + B.x.first + nx * B.y.first + nxy * B.z.first;
  LmeLanes v = LmeLanes::Zero(), vy = v, vz = v, vyy = v, vyz = v, vzz = v;
  for (int j = 0; j < W; ++j) {
    LmeLanes a = LmeLanes::Zero(), az = a, azz = a;
    for (int k = 0; k < W; ++k) {
      const LmeLanes row =
          Eigen::Map<const Eigen::Array<Coefficient, LmeBasis1d::kLanes, 1>>(base + j * nx + k * nxy)
              .template cast<double>();
      a += B.z.N[k] * row;
      if constexpr (order >= kGradient) az += B.z.dN[k] * row;
      if constexpr (order >= kHessian) azz += B.z.ddN[k] * row;
    }
    v += B.y.N[j] * a;
    if constexpr (order >= kGradient) {
      vy += B.y.dN[j] * a;
      vz += B.y.N[j] * az;
    }
    if constexpr (order >= kHessian) {
      vyy += B.y.ddN[j] * a;
      vyz += B.y.dN[j] * az;
      vzz += B.y.N[j] * azz;
    }
  }
  const LmeLanesMap N(B.x.N), dN(B.x.dN), ddN(B.x.ddN);
  LatticeJet f;
  f.value = (N * v).sum();
  if constexpr (order >= kGradient) f.gradient << (dN * v).sum(), (N * vy).sum(), (N * vz).sum();
  if constexpr (order >= kHessian) {
    const double xy = (dN * vy).sum(), xz = (dN * vz).sum(), yz = (N * vyz).sum();
    f.hessian << (ddN * v).sum(), xy, xz, xy, (N * vyy).sum(), yz, xz, yz, (N * vzz).sum();
  }
  return f;
}

/// f(std::integral_constant<int, W>) for a support of `width` = 4, 6 or 8 nodes an axis.
template <class F>
decltype(auto) dispatch_width(int width, F&& f) {
  if (width == 4) return f(std::integral_constant<int, 4>{});
  if (width == 6) return f(std::integral_constant<int, 6>{});
  return f(std::integral_constant<int, 8>{});
}

}  // namespace umtet::detail
