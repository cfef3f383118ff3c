#include "mesh/fast/smoothing/ring_newton.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "mesh/core/tet_quality.h"

namespace umtet::detail {
namespace {

using Pack = Eigen::Array<double, kPackSize, 1>;
using PackMap = Eigen::Map<const Pack, Eigen::Aligned32>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// log2 of the powers of F = 1 / Q^3 (but for a factor), one Newton step for each in turn: p = 16 and 32 here are the
// norms p = 48 and 96 of 1 / Q. The lower power is the smoother function and takes the vertex near its place; the
// higher one weighs the worst tet more.
constexpr int kFirstPower = 4, kLastPower = 5;
static_assert(kNorm == 3 << kLastPower);  // the p of 1/Q that goes with it
constexpr double kStepCap = .5;           // of h: farther away, a vertex leaves its star
constexpr double kVolumeKept = .2;    // of every V, in one step: farther off, the quadratic model of 1 / V^2 is useless
constexpr int kHalvings = 4;          // of a step that does not lower its sum; then the vertex waits for its next turn
constexpr int kUntangleRounds = 8;    // values of sigma; a vertex whose least volume rises is enqueued again
constexpr double kVolumeScale = .07;  // of h^3: a tenth of six times the volume of a background tet

PackMap pack(const std::array<double, kMaxRing>& a, int k) { return PackMap(a.data() + k); }

template <int log2_p, class T>
T to_power(T x) {
  for (int j = 0; j < log2_p; ++j) x *= x;
  return x;
}

Pack volumes(const OneRing& r, int k, const Vec3& y) {
  return pack(r.v, k) - (pack(r.nx, k) * y.x() + pack(r.ny, k) * y.y() + pack(r.nz, k) * y.z());
}

double least_volume(const OneRing& r, const Vec3& y) {
  Pack least = Pack::Constant(kInfinity);
  for (int k = 0; k < r.n; k += kPackSize) least = least.min(volumes(r, k, y));
  return least.minCoeff();
}

/// Without the factor 1 / 432 of F: scales take it out again.
struct Sum {
  double sum, max_F;  ///< infinite where some V <= 0
};
template <int log2_p>
Sum sum_of_powers(const OneRing& r, const Vec3& y, double scale) {
  const double y2 = 3 * y.squaredNorm(), inverse = 1 / scale;
  Pack sum = Pack::Zero(), greatest = Pack::Zero(), least_V = Pack::Constant(kInfinity);
  for (int k = 0; k < r.n; k += kPackSize) {
    const Pack V = volumes(r, k, y);
    const Pack L = pack(r.l, k) + (pack(r.sx, k) * y.x() + pack(r.sy, k) * y.y() + pack(r.sz, k) * y.z()) + y2;
    const Pack F = L * L * L / (V * V);
    least_V = least_V.min(V);
    greatest = greatest.max(F);
    sum += to_power<log2_p>(Pack(F * inverse));
  }
  if (!(least_V.minCoeff() > 0)) return {kInfinity, kInfinity};
  return {sum.sum(), greatest.maxCoeff()};
}

/// The sum at 0. \pre every V > 0 there
template <int log2_p>
double sum_of_powers_here(const OneRing& r, double scale) {
  const double inverse = 1 / scale;
  Pack sum = Pack::Zero();
  for (int k = 0; k < r.n; k += kPackSize) {
    const Pack V = pack(r.v, k), L = pack(r.l, k);
    sum += to_power<log2_p>(Pack(L * L * L / (V * V) * inverse));
  }
  return sum.sum();
}

template <int log2_p>
PowerSum power_sum_of(const OneRing& r, const Vec3& y, double scale) {
  const double y2 = 3 * y.squaredNorm(), inverse = 1 / scale, p = 1 << log2_p;
  Pack sum = Pack::Zero(), least_V = Pack::Constant(kInfinity), diagonal = Pack::Zero();
  std::array<Pack, 3> G = {Pack::Zero(), Pack::Zero(), Pack::Zero()};
  std::array<Pack, 6> M = {Pack::Zero(), Pack::Zero(), Pack::Zero(), Pack::Zero(), Pack::Zero(), Pack::Zero()};
  for (int k = 0; k < r.n; k += kPackSize) {
    const Pack Nx = pack(r.nx, k), Ny = pack(r.ny, k), Nz = pack(r.nz, k);
    const Pack Sx = pack(r.sx, k), Sy = pack(r.sy, k), Sz = pack(r.sz, k);
    const Pack V = pack(r.v, k) - (Nx * y.x() + Ny * y.y() + Nz * y.z());
    const Pack L = pack(r.l, k) + (Sx * y.x() + Sy * y.y() + Sz * y.z()) + y2;
    least_V = least_V.min(V);
    const Pack iV = 1 / V, iL = 1 / L;
    const Pack w = to_power<log2_p>(Pack(L * L * L * iV * iV * inverse));
    // b = -grad V / V, a = grad L / L, and g = grad ln F = 3 a + 2 b. Hess ln F = 18 / L I - 3 a a^T + 2 b b^T.
    const Pack bx = Nx * iV, by = Ny * iV, bz = Nz * iV;
    const Pack ax = (Sx + 6 * y.x()) * iL, ay = (Sy + 6 * y.y()) * iL, az = (Sz + 6 * y.z()) * iL;
    const Pack gx = 3 * ax + 2 * bx, gy = 3 * ay + 2 * by, gz = 3 * az + 2 * bz;
    sum += w;
    diagonal += w * iL;
    G[0] += w * gx, G[1] += w * gy, G[2] += w * gz;
    const Pack pw = p * w, a3 = 3 * w, b2 = 2 * w;
    M[0] += pw * gx * gx - a3 * ax * ax + b2 * bx * bx;
    M[1] += pw * gy * gy - a3 * ay * ay + b2 * by * by;
    M[2] += pw * gz * gz - a3 * az * az + b2 * bz * bz;
    M[3] += pw * gx * gy - a3 * ax * ay + b2 * bx * by;
    M[4] += pw * gx * gz - a3 * ax * az + b2 * bx * bz;
    M[5] += pw * gy * gz - a3 * ay * az + b2 * by * bz;
  }
  PowerSum result;
  if (!(least_V.minCoeff() > 0)) {
    result.sum = kInfinity;
    return result;
  }
  result.sum = sum.sum();
  const double one = 1 / result.sum, d = 18 * diagonal.sum() * one;
  result.gradient = Vec3(G[0].sum(), G[1].sum(), G[2].sum()) * one;
  const double xy = M[3].sum() * one, xz = M[4].sum() * one, yz = M[5].sum() * one;
  result.hessian << M[0].sum() * one + d, xy, xz, xy, M[1].sum() * one + d, yz, xz, yz, M[2].sum() * one + d;
  result.hessian -= p * result.gradient * result.gradient.transpose();
  return result;
}

/// H x = b for a symmetric H > 0 by cofactors; zero where it is not.
Vec3 solve(const Mat3& H, const Vec3& b) {
  const Vec3 c0 = H.col(1).cross(H.col(2)), c1 = H.col(2).cross(H.col(0)), c2 = H.col(0).cross(H.col(1));
  const double det = H.col(0).dot(c0);
  if (!(det > 0)) return Vec3::Zero();
  return (c0 * b.x() + c1 * b.y() + c2 * b.z()) / det;
}

/// The Newton step along a line. Not inlined: the rounding of the other steps would change with the code around them.
[[gnu::noinline]] Vec3 step_on_line(const Mat3& H, const Vec3& gradient, const Vec3& t) {
  const double curvature = t.dot(H * t);
  if (!(curvature > 0)) return Vec3::Zero();
  return -(t.dot(gradient) / curvature) * t;
}

/// The Newton step for a sum and its derivatives, along these directions.
Vec3 step_of(const PowerSum& at, const Directions& directions) {
  // The p-norm of 1/Q is exp(ln(sum) / 3 p): its Newton step goes with this matrix. That of the sum itself would
  // shrink like 1 / p far from the optimum, where one tet rules.
  const Mat3 H = at.hessian + at.gradient * at.gradient.transpose() / 3;
  if (directions.line) return step_on_line(H, at.gradient, directions.tangents.col(0));
  if (!directions.plane) return -solve(H, at.gradient);
  const auto& tangents = directions.tangents;
  const Eigen::Matrix2d H2 = tangents.transpose() * H * tangents;
  if (!(H2.determinant() > 0)) return Vec3::Zero();
  return -(tangents * (H2.inverse() * (tangents.transpose() * at.gradient)));
}

/// The greatest part of a step, at most all of it, that leaves every V the share kVolumeKept.
double volume_limit(const OneRing& r, const Vec3& y, const Vec3& step) {
  Pack shrink = Pack::Zero();
  for (int k = 0; k < r.n; k += kPackSize) {
    const Pack rate = pack(r.nx, k) * step.x() + pack(r.ny, k) * step.y() + pack(r.nz, k) * step.z();
    shrink = shrink.max(rate / volumes(r, k, y));
  }
  return std::min(1., (1 - kVolumeKept) / shrink.maxCoeff());
}

/// A Newton step from y for one power, if there is one that lowers the sum. Returns the sum in the scale of max_F on
/// entry.
template <int log2_p>
double newton_step(const OneRing& ring, double h, const Directions& directions, Vec3& y, double& max_F) {
  const double scale = max_F;
  const PowerSum at = power_sum_of<log2_p>(ring, y, scale);
  Vec3 step = step_of(at, directions);
  const double length = step.norm();
  if (!(length > 0) || !std::isfinite(length)) return at.sum;
  if (length > kStepCap * h) step *= kStepCap * h / length;
  step *= volume_limit(ring, y, step);
  for (int halving = 0; halving <= kHalvings; ++halving, step *= .5) {
    const Sum there = sum_of_powers<log2_p>(ring, y + step, scale);
    if (!(there.sum < at.sum)) continue;
    y += step;
    max_F = there.max_F;
    return there.sum;
  }
  return at.sum;
}

/// From y, a Newton step for each power. Returns where they end, with the last sum in the scale of max_F.
/// \pre every V > 0 at y
Displacement newton(const OneRing& ring, Vec3 y, double h, const Directions& directions, double max_F) {
  const double scale = max_F;
  newton_step<kFirstPower>(ring, h, directions, y, max_F);
  const double ratio = max_F / scale;
  const double sum = newton_step<kLastPower>(ring, h, directions, y, max_F);
  return {y, sum * to_power<kLastPower>(ratio)};
}

/// From y, moves until every V > 0 or min V rises no more.
Vec3 untangle(const OneRing& ring, Vec3 y, double h, const Directions& directions) {
  const double unit = kVolumeScale * h * h * h;
  OneRing shifted = ring;
  for (int round = 0; round < kUntangleRounds; ++round) {
    const double least = least_volume(ring, y);
    if (least > 0) break;
    const double sigma = unit - least;
    for (int j = 0; j < ring.n; ++j) shifted.v[j] = ring.v[j] + sigma;
    const Vec3 next = newton(shifted, y, h, directions, sum_of_powers<0>(shifted, y, 1).max_F).y;
    if (!(least_volume(ring, next) > least)) break;
    y = next;
  }
  return y;
}

}  // namespace

void silence_padding(OneRing& r) {
  for (int j = r.n; j % kPackSize != 0; ++j) r.v[j] = kInfinity, r.nx[j] = r.ny[j] = r.nz[j] = 0;
}

Bar::Bar(const OneRing& ring, double h, double gain) : scale(1 / ring.f_here) {
  if (ring.f_here > 0) {
    sum = sum_of_powers_here<kLastPower>(ring, scale);
    least_gain = kNorm * gain;
  } else {
    least_volume = detail::least_volume(ring, Vec3::Zero());
    least_gain = kVolumeScale * h * h * h * gain;
  }
}

bool Bar::passed(const OneRing& ring, const Vec3& y) const {
  if (tangled()) return detail::least_volume(ring, y) > least_volume + least_gain;
  return passed(sum_of_powers<kLastPower>(ring, y, scale).sum);
}

Displacement best_displacement(const OneRing& ring, const Bar& bar, double h, const Directions& directions) {
  if (!bar.tangled()) return newton(ring, Vec3::Zero(), h, directions, bar.scale);
  const Vec3 y = untangle(ring, Vec3::Zero(), h, directions);
  const double max_F = sum_of_powers<0>(ring, y, 1).max_F;
  return {std::isfinite(max_F) ? newton(ring, y, h, directions, max_F).y : y, kNaN};
}

std::bitset<kMaxRing> tets_below_target(const OneRing& ring, const Vec3& y, double good_f) {
  static_assert(kMaxRing == 128);
  std::array<std::uint64_t, 2> below_target{};
  const double y2 = 3 * y.squaredNorm();
  for (int k = 0; k < ring.n; k += kPackSize) {
    const Pack V0 = pack(ring.v, k), V1 = volumes(ring, k, y), L0 = pack(ring.l, k);
    const Pack L1 = L0 + (pack(ring.sx, k) * y.x() + pack(ring.sy, k) * y.y() + pack(ring.sz, k) * y.z()) + y2;
    const Pack f = (V0 * V0.abs() / (L0 * L0 * L0)).min(V1 * V1.abs() / (L1 * L1 * L1));
    for (int m = 0; m < kPackSize; ++m)
      below_target[k / 64] |= static_cast<std::uint64_t>(f[m] < good_f) << (k % 64 + m);
  }
  return std::bitset<kMaxRing>(below_target[1]) << 64 | std::bitset<kMaxRing>(below_target[0]);
}

PowerSum power_sum(const OneRing& ring, const Vec3& y, int log2_p, double scale) {
  OneRing silenced = ring;
  silence_padding(silenced);
  scale *= kMeanRatioFactor * kMeanRatioFactor * kMeanRatioFactor;
  if (log2_p == kFirstPower) return power_sum_of<kFirstPower>(silenced, y, scale);
  if (log2_p == kLastPower) return power_sum_of<kLastPower>(silenced, y, scale);
  throw std::invalid_argument("power_sum: log2_p = " + std::to_string(log2_p) + ": must be 4 or 5");
}

}  // namespace umtet::detail
