#include "mesh/detail/tet_lanes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "mesh/orientation.h"
#include "mesh/tet_quality.h"

namespace umtet::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Lane3 {
  Lane x, y, z;

  Lane3 operator-(const Lane3& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Lane dot(const Lane3& o) const { return x * o.x + y * o.y + z * o.z; }
  Lane3 cross(const Lane3& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};

/// Corner k of the tets.
Lane3 corner(const TetMesh& mesh, const std::array<const Tet*, kLanes>& tets, int k) {
  static_assert(kLanes == 4);
  const Vec3 &a = mesh.V[(*tets[0])[k]], &b = mesh.V[(*tets[1])[k]], &c = mesh.V[(*tets[2])[k]],
             &d = mesh.V[(*tets[3])[k]];
  return {Lane(a.x(), b.x(), c.x(), d.x()), Lane(a.y(), b.y(), c.y(), d.y()), Lane(a.z(), b.z(), c.z(), d.z())};
}

/// Cube roots of numbers in [1e-30, 2], to a few roundings.
Lane cube_roots(const Lane& x) {
  Lane root;
  // A third of the bits of a float is a root within 5 % [Kahan1991]; three steps of Halley leave .05^27.
  for (int m = 0; m < kLanes; ++m) {
    root[m] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(static_cast<float>(x[m])) / 3 + 0x2a5137a0u);
  }
  for (int step = 0; step < 3; ++step) {
    const Lane cube = root * root * root;
    root *= (cube + 2 * x) / (2 * cube + x);
  }
  return root;
}

/// Q from r = V / L^(3/2), V six volumes, L the sum of squared edges.
Lane mean_ratios(const Lane& r) {
  constexpr double kCube = kMeanRatioFactor * kMeanRatioFactor * kMeanRatioFactor;
  const Lane cubes = kCube * r * r;
  if ((cubes >= 1e-30 && cubes <= 2.).all()) {
    const Lane Q = cube_roots(cubes);
    return (r < 0).select(-Q, Q);
  }
  Lane Q;
  for (int m = 0; m < kLanes; ++m) {
    Q[m] = std::copysign(std::cbrt(cubes[m]), r[m]);
    if (!std::isfinite(Q[m])) Q[m] = -1;
  }
  return Q;
}

}  // namespace

TetLanes measure_tet_lanes(const TetMesh& mesh, const Tet* tets, int count) {
  std::array<const Tet*, kLanes> tet;
  for (int m = 0; m < kLanes; ++m) tet[m] = tets + std::min(m, count - 1);
  const Lane3 origin = corner(mesh, tet, 0);
  const Lane3 u = corner(mesh, tet, 1) - origin, v = corner(mesh, tet, 2) - origin, w = corner(mesh, tet, 3) - origin;
  const Lane3 vu = v - u, wu = w - u, wv = w - v;
  const std::array<Lane, 6> edge2 = {u.dot(u), v.dot(v), w.dot(w), vu.dot(vu), wu.dot(wu), wv.dot(wv)};
  const Lane L = edge2[0] + edge2[1] + edge2[2] + edge2[3] + edge2[4] + edge2[5];

  // The terms of the filter of orientation_sign().
  const Lane p0 = v.y * w.z, p1 = v.z * w.y, p2 = v.z * w.x, p3 = v.x * w.z, p4 = v.x * w.y, p5 = v.y * w.x;
  const Lane3 b = {p1 - p0, p3 - p2, p5 - p4}, c = u.cross(w), d = v.cross(u);  // outward, opposite to each vertex
  const Lane3 a = {-(b.x + c.x + d.x), -(b.y + c.y + d.y), -(b.z + c.z + d.z)};
  TetLanes result;
  result.volume6 = -u.dot(b);
  const Lane permanent =
      u.x.abs() * (p0.abs() + p1.abs()) + u.y.abs() * (p2.abs() + p3.abs()) + u.z.abs() * (p4.abs() + p5.abs());
  constexpr double kGreatest2 = kFilterGreatest * kFilterGreatest;
  if (!(result.volume6 > kFilterBound * permanent && permanent > kFilterLeast && L < kGreatest2).all()) {
    for (int m = 0; m < kLanes; ++m) {
      const Tet& t = *tet[m];
      result.inverted[m] = orientation_sign(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]) <= 0;
    }
  }

  const Lane root_L = L.sqrt();
  result.rms_edge = root_L * std::sqrt(1. / 6);
  result.quality = mean_ratios(result.volume6 / (L * root_L));

  // A dihedral angle is that of the normals of its two faces, and the sine of it times their lengths is that of the
  // edge times six volumes.
  const std::array<Lane, 6> cosine = {-c.dot(d), -b.dot(d), -b.dot(c), -a.dot(d), -a.dot(c), -a.dot(b)};
  const Lane per_volume = 1 / result.volume6.abs();
  Lane least = Lane::Constant(kInfinity), greatest = Lane::Constant(-kInfinity);
  for (int k = 0; k < 6; ++k) {
    const Lane cotangent = cosine[k] * per_volume;  // times the edge
    const Lane square = cotangent * cotangent.abs() / edge2[k];
    least = (square < least).select(square, least);  // what is not a number is passed over
    greatest = (square > greatest).select(square, greatest);
  }
  result.least_cotangent = least;
  result.greatest_cotangent = greatest;
  return result;
}

}  // namespace umtet::detail
