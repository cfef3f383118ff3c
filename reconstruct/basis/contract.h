#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>

#include "reconstruct/basis/lme_lattice.h"
#include "reconstruct/basis/simd_packs.h"

namespace umtet::simd {

using LmePack = Eigen::Array<double, LmeBasis1d::kPackSize, 1>;
using LmePackMap = Eigen::Map<const LmePack, Eigen::Aligned32>;

/// Order of the highest derivatives in a jet.
enum JetOrder { kValue = 0, kGradient = 1, kHessian = 2 };

/// f = sum c_a N_a and its derivatives up to `order`.
struct LatticeJet {
  double value = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

/// Accumulator of a jet with four partial sums per number: f, fx fy fz, fxx fxy fxz fyy fyz fzz. Terms are added lane
/// by lane, and the lanes are added once at the end.
template <JetOrder order>
struct JetPacks {
  static constexpr int kNumbers = order == kValue ? 1 : order == kGradient ? 4 : 10;
  Pack4d f[kNumbers];

  JetPacks() {
#pragma GCC unroll 10
    for (int q = 0; q < kNumbers; ++q) f[q] = Pack4d{};  // GCC compiles "= {}" to a slow string instruction
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

/// Loads the nodes 0 .. W - 1 of two neighbouring rows as W / 2 vectors: four nodes of each, then the rests. For W = 6
/// the rests of both rows share a vector.
template <int W, class Coefficient>
void load_rows(const Coefficient* row, const Coefficient* next, Pack4d* c) {
  c[0] = four(row), c[1] = four(next);
  if constexpr (W == 6) c[2] = two_and_two(row + 4, next + 4);
  if constexpr (W == 8) c[2] = four(row + 4), c[3] = four(next + 4);
}

/// Adds sum c_a N_a over the W^3 nodes around a point, by contraction over z, y, then x, whose W nodes are four lanes
/// and a rest.
/// Every product is added by fused(): GCC may fuse either product of a b + c d, and psi alone must have the same bits
/// as psi with its derivatives.
/// @param base    coefficient (double or float) of the first node of all axes
/// @param nx, nxy strides of coefficients along y and z: numbers, or integral constants if they are known
template <int W, JetOrder order, class Coefficient, class Nx, class Nxy>
[[gnu::noinline, gnu::noclone]] void contract(const LmeBasis3d& B, const Coefficient* base, Nx nx, Nxy nxy,
                                              JetPacks<order>& sum) {
  constexpr int kPairs = W / 2, kVectors = W / 2;
  const double *zN[3] = {B.z.N, B.z.dN, B.z.ddN}, *yN[3] = {B.y.N, B.y.dN, B.y.ddN};
  Pack4d a[kPairs][order + 1][kVectors];  // by rows, derivative in z
  for (int pair = 0; pair < kPairs; ++pair) {
    const Coefficient* row = base + 2 * pair * nx;
    Pack4d s[order + 1][kVectors], c[kVectors];
    load_rows<W>(row, row + nx, c);
    for (int d = 0; d <= order; ++d)
      for (int v = 0; v < kVectors; ++v) s[d][v] = zN[d][0] * c[v];
        // Not unrolled: GCC would load all of z at once, which exceeds the number of registers, and loads are the
        // bottleneck.
#pragma GCC unroll 1
    for (int k = 1; k < W; ++k) {
      row += nxy;
      load_rows<W>(row, row + nx, c);
      for (int d = 0; d <= order; ++d)
        for (int v = 0; v < kVectors; ++v) s[d][v] = fused(all(zN[d][k]), c[v], s[d][v]);
    }
    for (int d = 0; d <= order; ++d)
      for (int v = 0; v < kVectors; ++v) a[pair][d][v] = s[d][v];
  }
  // Sums over y, and their contributions to the jet. weight(d, t), term(d, t): derivative d in y, or in z, of the t-th
  // of n terms; x(N): their lanes of x
  const auto along_yx = [&](int n, auto weight, auto term, auto x) {
    constexpr int kSums = order == kValue ? 1 : order == kGradient ? 3 : 6;
    constexpr int kY[6] = {0, 1, 0, 2, 1, 0}, kZ[6] = {0, 0, 1, 0, 1, 2};
    Pack4d s[kSums];
#pragma GCC unroll 6
    for (int q = 0; q < kSums; ++q) s[q] = weight(kY[q], 0) * term(kZ[q], 0);
#pragma GCC unroll 8
    for (int t = 1; t < n; ++t)
#pragma GCC unroll 6
      for (int q = 0; q < kSums; ++q) s[q] = fused(weight(kY[q], t), term(kZ[q], t), s[q]);
    const auto add = [&](int q, Pack4d x, Pack4d v) { sum.f[q] = fused(x, v, sum.f[q]); };
    const Pack4d N = x(B.x.N);
    add(0, N, s[0]);
    if constexpr (order >= kGradient) {
      const Pack4d dN = x(B.x.dN);
      add(1, dN, s[0]), add(2, N, s[1]), add(3, N, s[2]);
      if constexpr (order >= kHessian) {
        add(4, x(B.x.ddN), s[0]), add(5, dN, s[1]), add(6, dN, s[2]);
        add(7, N, s[3]), add(8, N, s[4]), add(9, N, s[5]);
      }
    }
  };
  const auto y_of_row = [&](int d, int j) { return all(yN[d][j]); };
  along_yx(
      W, y_of_row, [&](int d, int j) { return a[j / 2][d][j % 2]; }, [](const double* N) { return four(N); });
  if constexpr (W == 6) {
    along_yx(
        kPairs,
        [&](int d, int p) {
          return Pack4d{yN[d][2 * p], yN[d][2 * p], yN[d][2 * p + 1], yN[d][2 * p + 1]};
        },
        [&](int d, int p) { return a[p][d][2]; }, [](const double* N) { return two_and_two(N + 4, N + 4); });
  }
  if constexpr (W == 8) {
    along_yx(
        W, y_of_row, [&](int d, int j) { return a[j / 2][d][2 + j % 2]; }, [](const double* N) { return four(N + 4); });
  }
}

/// Contraction on a whole lattice.
/// @param c  coefficients of a lattice of n nodes
template <int W, JetOrder order, class Coefficient>
LatticeJet contract(const LmeBasis3d& B, const Eigen::Vector3i& n, const Coefficient* c) {
  const std::ptrdiff_t nx = n[0], nxy = nx * n[1];
  JetPacks<order> sum;
  contract<W, order>(B, c + B.x.first + nx * B.y.first + nxy * B.z.first, nx, nxy, sum);
  return sum.sum();
}

/// Calls f(std::integral_constant<int, W>) for a support of `width` = 4, 6 or 8 nodes per axis.
template <class F>
decltype(auto) dispatch_width(int width, F&& f) {
  if (width == 4) return f(std::integral_constant<int, 4>{});
  if (width == 6) return f(std::integral_constant<int, 6>{});
  return f(std::integral_constant<int, 8>{});
}

}  // namespace umtet::simd
