#include "mesh/core/tet_packs.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "mesh/core/orientation.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Least and greatest squared lengths whose cubes, like the squares of volumes, are normal doubles.
constexpr double kLeast2 = 1e-80, kGreatest2 = 1e80;

Pack all_packs(double a) { return Pack{a, a, a, a}; }
/// The absolute value; +0 of -0, so that 1 / |V| of a flat tet is +infinity.
Pack magnitude(Pack a) {
  using Bits = std::int64_t __attribute__((vector_size(8 * kPackSize)));
  return (Pack)((Bits)a & std::numeric_limits<std::int64_t>::max());
}
/// @param mask  result of a comparison: each element is -1 or 0
template <class Mask>
bool is_all(Mask mask) {
  return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
}

struct Lane3 {
  Pack x, y, z;

  Lane3 operator-(const Lane3& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Pack dot(const Lane3& o) const { return x * o.x + y * o.y + z * o.z; }
  Lane3 cross(const Lane3& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};

/// Corner k of the tets.
Lane3 corner(const TetMesh& mesh, const std::array<const Tet*, kPackSize>& tets, int k) {
  static_assert(kPackSize == 4);
  const Vec3 &a = mesh.V[(*tets[0])[k]], &b = mesh.V[(*tets[1])[k]], &c = mesh.V[(*tets[2])[k]],
             &d = mesh.V[(*tets[3])[k]];
  return {Pack{a.x(), b.x(), c.x(), d.x()}, Pack{a.y(), b.y(), c.y(), d.y()}, Pack{a.z(), b.z(), c.z(), d.z()}};
}

/// By Eigen, which has the instruction for all at once.
Pack square_roots(Pack x) {
  Eigen::Array<double, kPackSize, 1> roots;
  std::memcpy(roots.data(), &x, sizeof x);
  roots = roots.sqrt();
  std::memcpy(&x, roots.data(), sizeof x);
  return x;
}

/// Cube roots of numbers in [1e-30, 2], to a few roundings.
Pack cube_roots(Pack x) {
  using Floats = float __attribute__((vector_size(4 * kPackSize)));
  using Bits = std::uint32_t __attribute__((vector_size(4 * kPackSize)));
  // A third of the bits of a float is a root within 5 % [Kahan1991]; what follows, y (1 + u)^(-1/3) by its Pade
  // approximant [2/2] in u = y^3 / x - 1, leaves .0016 |u|^5: 2e-7, then rounding.
  const auto third = (Bits) __builtin_convertvector(x, Floats) / 3 + 0x2a5137a0u;
  Pack y = __builtin_convertvector((Floats)third, Pack);
  for (int step = 0; step < 2; ++step) {
    const Pack c = y * y * y;
    y *= (14 * x * x + c * (35 * x + 5 * c)) / (5 * x * x + c * (35 * x + 14 * c));
  }
  return y;
}

/// Q from six volumes V and the sum L of squared edges.
Pack mean_ratios(Pack V, Pack L) {
  constexpr double kCube = kMeanRatioFactor * kMeanRatioFactor * kMeanRatioFactor;
  const Pack cubes = kCube * V * V / (L * L * L);
  const auto is_in_range = (cubes >= 1e-30) & (cubes <= 2.) & (L >= kLeast2) & (L <= kGreatest2);
  const Pack root = cube_roots(is_in_range ? cubes : all_packs(1));
  Pack Q = V < 0 ? -root : root;
  if (is_all(is_in_range)) return Q;
  for (int m = 0; m < kPackSize; ++m) {
    if (is_in_range[m] != 0) continue;
    const double side = std::sqrt(L[m]), root_of_volume = std::cbrt(V[m] / (L[m] * side));
    Q[m] = kMeanRatioFactor * root_of_volume * std::abs(root_of_volume);
    if (!std::isfinite(Q[m])) Q[m] = -1;
  }
  return Q;
}

}  // namespace

TetPack measure_tet_pack(const TetMesh& mesh, const Tet* tets, int count) {
  std::array<const Tet*, kPackSize> tet;
  for (int m = 0; m < kPackSize; ++m) tet[m] = tets + std::min(m, count - 1);
  const Lane3 origin = corner(mesh, tet, 0);
  const Lane3 u = corner(mesh, tet, 1) - origin, v = corner(mesh, tet, 2) - origin, w = corner(mesh, tet, 3) - origin;
  const Lane3 vu = v - u, wu = w - u, wv = w - v;
  const std::array<Pack, 6> edge2 = {u.dot(u), v.dot(v), w.dot(w), vu.dot(vu), wu.dot(wu), wv.dot(wv)};
  const Pack L = edge2[0] + edge2[1] + edge2[2] + edge2[3] + edge2[4] + edge2[5];

  // The terms of the filter of orientation_sign().
  const Pack p0 = v.y * w.z, p1 = v.z * w.y, p2 = v.z * w.x, p3 = v.x * w.z, p4 = v.x * w.y, p5 = v.y * w.x;
  const Lane3 b = {p1 - p0, p3 - p2, p5 - p4}, c = u.cross(w), d = v.cross(u);  // outward, opposite to each vertex
  const Lane3 a = {-(b.x + c.x + d.x), -(b.y + c.y + d.y), -(b.z + c.z + d.z)};
  TetPack result;
  result.volume6 = 0 - u.dot(b);  // never -0, nor is Q
  const Pack permanent = magnitude(u.x) * (magnitude(p0) + magnitude(p1)) +
                         magnitude(u.y) * (magnitude(p2) + magnitude(p3)) +
                         magnitude(u.z) * (magnitude(p4) + magnitude(p5));
  constexpr double kFilterGreatest2 = kFilterGreatest * kFilterGreatest;
  if (!is_all((result.volume6 > kFilterBound * permanent) & (permanent > kFilterLeast) & (L < kFilterGreatest2))) {
    for (int m = 0; m < kPackSize; ++m) {
      const Tet& t = *tet[m];
      result.inverted[m] = orientation_sign(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]) <= 0;
    }
  }

  result.rms_edge = square_roots(L / 6);
  result.quality = mean_ratios(result.volume6, L);

  // A dihedral angle is that of the normals of its two faces, and the sine of it times their lengths is that of the
  // edge times six volumes.
  const std::array<Pack, 6> cosine = {-c.dot(d), -b.dot(d), -b.dot(c), -a.dot(d), -a.dot(c), -a.dot(b)};
  const Pack per_volume = 1 / magnitude(result.volume6);
  Pack least = all_packs(kInfinity), greatest = all_packs(-kInfinity);
  for (int k = 0; k < 6; ++k) {
    const Pack cotangent = cosine[k] * per_volume;  // times the edge
    const Pack square = cotangent * magnitude(cotangent) / edge2[k];
    least = square < least ? square : least;  // a NaN is left out
    greatest = square > greatest ? square : greatest;
  }
  result.least_cotangent = least;
  result.greatest_cotangent = greatest;
  return result;
}

}  // namespace umtet
