#pragma once

#include <Eigen/Core>

#include "reconstruct/basis/lme_lattice.h"
#include "reconstruct/solve/ssd_sample.h"

namespace umtet::detail {

using namespace simd;

using FloatPack = Eigen::Array<float, LmeBasis1d::kPackSize, 1>;
using FloatIn = Eigen::Map<const FloatPack>;
inline Eigen::Map<FloatPack> float_pack(float* at) { return Eigen::Map<FloatPack>(at); }

/// Stored data of a sample in single precision: eight lanes of N and N' in x, W values each in y and z, and the two
/// weights.
template <int W>
struct SampleBasis {
  static constexpr int kStride = 16 + 4 * W + 2;
  const float* at;
  FloatIn xN() const { return FloatIn(at); }
  FloatIn xdN() const { return FloatIn(at + 8); }
  const float* yN() const { return at + 16; }
  const float* ydN() const { return at + 16 + W; }
  const float* zN() const { return at + 16 + 2 * W; }
  const float* zdN() const { return at + 16 + 3 * W; }
  float w_value() const { return at[16 + 4 * W]; }
  float w_gradient() const { return at[16 + 4 * W + 1]; }

  static void store(const LmeBasis3d& B, const SsdSample& s, float* at) {
    for (int a = 0; a < 8; ++a) {
      at[a] = static_cast<float>(B.x.N[a]);
      at[8 + a] = static_cast<float>(B.x.dN[a]);
    }
    for (int a = 0; a < W; ++a) {
      at[16 + a] = static_cast<float>(B.y.N[a]);
      at[16 + W + a] = static_cast<float>(B.y.dN[a]);
      at[16 + 2 * W + a] = static_cast<float>(B.z.N[a]);
      at[16 + 3 * W + a] = static_cast<float>(B.z.dN[a]);
    }
    at[16 + 4 * W] = static_cast<float>(s.w_value);
    at[16 + 4 * W + 1] = static_cast<float>(s.w_gradient);
  }
};

/// y += q N + g . grad N over the W^3 nodes of a sample, with the conventions of add_sample().
template <int W, class Nx, class Nxy>
void scatter_sample(const SampleBasis<W>& B, float q, float gx, float gy, float gz, float* y, Nx nx, Nxy nxy) {
  const FloatPack N = B.xN(), t = q * N + gx * B.xdN(), ty = gy * N, tz = gz * N;
  FloatPack a[W], az[W];
#pragma GCC unroll 8
  for (int j = 0; j < W; ++j) a[j] = B.yN()[j] * t + B.ydN()[j] * ty, az[j] = B.yN()[j] * tz;
#pragma GCC unroll 1
  for (int k = 0; k < W; ++k) {
    const float zN = B.zN()[k], zdN = B.zdN()[k];
#pragma GCC unroll 8
    for (int j = 0; j < W; ++j) float_pack(y + k * nxy + j * nx) += zN * a[j] + zdN * az[j];
  }
}

/// y += (w_v N N^T + w_g grad N . grad N^T) c over the W^3 nodes of a sample. Eight-lane loads and stores extend beyond
/// the last node of a row, and add zero there.
/// @param c, y    at the first node of all axes
/// @param nx, nxy distance of nodes along y and z
template <int W, class Nx, class Nxy>
void add_sample(const SampleBasis<W>& B, const float* c, float* y, Nx nx, Nxy nxy) {
  // Plane by plane: 2 W sums stay in registers, and each weight in z is loaded once.
  FloatPack a[W], az[W];
#pragma GCC unroll 8
  for (int j = 0; j < W; ++j) a[j].setZero(), az[j].setZero();
#pragma GCC unroll 1
  for (int k = 0; k < W; ++k) {
    const float N = B.zN()[k], dN = B.zdN()[k];
#pragma GCC unroll 8
    for (int j = 0; j < W; ++j) {
      const FloatPack row = FloatIn(c + k * nxy + j * nx);
      a[j] += N * row;
      az[j] += dN * row;
    }
  }
  FloatPack v = FloatPack::Zero(), vy = v, vz = v;
#pragma GCC unroll 8
  for (int j = 0; j < W; ++j) {
    v += B.yN()[j] * a[j];
    vy += B.ydN()[j] * a[j];
    vz += B.yN()[j] * az[j];
  }
  const FloatPack N = B.xN(), dN = B.xdN();
  const float q = B.w_value() * (N * v).sum(), w = B.w_gradient();
  const float gx = w * (dN * v).sum(), gy = w * (N * vy).sum(), gz = w * (N * vz).sum();
  scatter_sample<W>(B, q, gx, gy, gz, y, nx, nxy);
}

}  // namespace umtet::detail
