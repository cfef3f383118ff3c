#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>

#include "reconstruct/detail/lanes.h"
#include "reconstruct/lme_lattice.h"

namespace umtet::detail {

using LmeLanes = Eigen::Array<double, LmeBasis1d::kLanes, 1>;
using LmeLanesMap = Eigen::Map<const LmeLanes, Eigen::Aligned32>;

enum JetOrder { kValue = 0, kGradient = 1, kHessian = 2 };

/// f = sum c_a N_a and its derivatives, up to the order asked for.
struct LatticeJet {
  double value = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

/// The numbers of a jet as four partial sums each: f, fx fy fz, fxx fxy fxz fyy fyz fzz. Terms are added lane by lane,
/// and the lanes once at the end.
template <JetOrder order>
struct JetLanes {
  static constexpr int kNumbers = order == kValue ? 1 : order == kGradient ? 4 : 10;
  Lanes4d f[kNumbers];

  JetLanes() {
#pragma GCC unroll 10
    for (int q = 0; q < kNumbers; ++q) f[q] = Lanes4d{};  // GCC makes a slow string instruction of "= {}"
  }
  LatticeJet sum() const {
    double s[10];
    for (int q = 0; q < kNumbers; ++q) s[q] = (f[q][0] + f[q][2]) + (f[q][1] + f[q][3]);
    LatticeJet jet;
    jet.value = s[0];
    if constexpr (order >= kGradient) jet.gradient << s[1], s[2], s[3];
    if constexpr (order >= kHessian) jet.hessian << s[4], s[5], s[6], s[5], s[7], s[8], s[6], s[8], s[9];
    return jet;
  }
};

/// Adds sum c_a N_a over the W^3 nodes around a point: contraction over z, y, then x, whose W nodes are four lanes and
/// a rest. Of W = 6 the rests of two neighbours in z share a vector.
/// Not inlined, and its loops not unrolled where sums begin with zero: GCC is free to fuse either product of a b + c d,
/// and psi alone has to have the bits of psi with its derivatives.
/// @param base    coefficient (double or float) of the first node of all axes
/// @param nx, nxy distance of coefficients along y and z
template <int W, JetOrder order, class Coefficient>
[[gnu::noinline, gnu::noclone]] void contract(const LmeBasis3d& B, const Coefficient* base, std::ptrdiff_t nx,
                                              std::ptrdiff_t nxy, JetLanes<order>& sum) {
  constexpr bool kRest = W > 4;
  constexpr int kRows = W == 6 ? 3 : 2;  // rows at once: their sums fit the registers, and share what is loaded of z
  // The loops over k are not unrolled: GCC would keep the addresses of all rows at once, on the stack.
  const double* zN[3] = {B.z.N, B.z.dN, B.z.ddN};
  Lanes4d a[W][order + 1], rest[W][order + 1];  // by derivative in z
  for (int j = 0; j < W; j += kRows) {
    const Coefficient* row = base + j * nx;
    Lanes4d s[kRows][order + 1] = {};
#pragma GCC unroll 1
    for (int k = 0; k < W; ++k)
#pragma GCC unroll 8
      for (int q = 0; q < kRows; ++q) {
        const Lanes4d c = four(row + q * nx + k * nxy);
        for (int d = 0; d <= order; ++d) s[q][d] += zN[d][k] * c;
      }
    for (int q = 0; q < kRows; ++q)
      for (int d = 0; d <= order; ++d) a[j + q][d] = s[q][d];
    if constexpr (kRest) {
      Lanes4d t[kRows][order + 1] = {};
#pragma GCC unroll 1
      for (int k = 0; k < W; k += W == 6 ? 2 : 1)
#pragma GCC unroll 8
        for (int q = 0; q < kRows; ++q) {
          const Coefficient* at = row + q * nx + k * nxy + 4;
          const Lanes4d c = W == 6 ? two_and_two(at, at + nxy) : four(at);
          for (int d = 0; d <= order; ++d) {
            const double* z = zN[d] + k;
            t[q][d] += (W == 6 ? Lanes4d{z[0], z[0], z[1], z[1]} : Lanes4d{z[0], z[0], z[0], z[0]}) * c;
          }
        }
      for (int q = 0; q < kRows; ++q)
        for (int d = 0; d <= order; ++d) rest[j + q][d] = t[q][d];
    }
  }
  const auto along_x = [&](const auto& a, const double* N, const double* dN, const double* ddN, bool twice) {
    Lanes4d v = {}, vy = {}, vz = {}, vyy = {}, vyz = {}, vzz = {};
#pragma GCC unroll 1
    for (int j = 0; j < W; ++j) {
      v += B.y.N[j] * a[j][0];
      if constexpr (order >= kGradient) {
        vy += B.y.dN[j] * a[j][0];
        vz += B.y.N[j] * a[j][1];
      }
      if constexpr (order >= kHessian) {
        vyy += B.y.ddN[j] * a[j][0];
        vyz += B.y.dN[j] * a[j][1];
        vzz += B.y.N[j] * a[j][2];
      }
    }
    const auto lanes = [&](const double* N) { return twice ? two_and_two(N, N) : four(N); };
    const Lanes4d x = lanes(N);
    sum.f[0] += x * v;
    if constexpr (order >= kGradient) {
      const Lanes4d dx = lanes(dN);
      sum.f[1] += dx * v, sum.f[2] += x * vy, sum.f[3] += x * vz;
      if constexpr (order >= kHessian) {
        sum.f[4] += lanes(ddN) * v, sum.f[5] += dx * vy, sum.f[6] += dx * vz;
        sum.f[7] += x * vyy, sum.f[8] += x * vyz, sum.f[9] += x * vzz;
      }
    }
  };
  along_x(a, B.x.N, B.x.dN, B.x.ddN, false);
  if constexpr (kRest) along_x(rest, B.x.N + 4, B.x.dN + 4, B.x.ddN + 4, W == 6);
}

/// The same alone, of a whole lattice.
/// @param c  coefficients of a lattice of n nodes
template <int W, JetOrder order, class Coefficient>
LatticeJet contract(const LmeBasis3d& B, const Eigen::Vector3i& n, const Coefficient* c) {
  const std::ptrdiff_t nx = n[0], nxy = nx * n[1];
  JetLanes<order> sum;
  contract<W, order>(B, c + B.x.first + nx * B.y.first + nxy * B.z.first, nx, nxy, sum);
  return sum.sum();
}

/// f(std::integral_constant<int, W>) for a support of `width` = 4, 6 or 8 nodes an axis.
template <class F>
decltype(auto) dispatch_width(int width, F&& f) {
  if (width == 4) return f(std::integral_constant<int, 4>{});
  if (width == 6) return f(std::integral_constant<int, 6>{});
  return f(std::integral_constant<int, 8>{});
}

}  // namespace umtet::detail
