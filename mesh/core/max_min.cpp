#include "mesh/core/max_min.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mesh/core/tet_quality.h"
#ifdef UMTET_WITH_GSL
#include "mesh/core/polynomial_roots.h"
#endif

namespace umtet {
namespace {

using Pack = Eigen::Array<double, kPackSize, 1>;
using PackMap = Eigen::Map<const Pack, Eigen::Aligned32>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kGoldenSteps = 10;  // [Rangarajan2018, Section 3.8(d)]

PackMap pack(const std::array<double, kMaxRing>& a, int k) { return PackMap(a.data() + k); }

void put(std::array<double, kMaxRing>& a, int k, const Pack& x) {
  Eigen::Map<Pack, Eigen::Aligned32>(a.data() + k) = x;
}

Pack f_of(const Pack& V, const Pack& L) { return V * V.abs() / (L * L * L); }

struct Probe {
  double f;
  int tet;
};

/// The least f at lambda and whose it is (the first one's, among equals).
Probe lowest(const RingOnLine& r, double lambda) {
  alignas(32) std::array<double, kMaxRing> f;
  Pack least = Pack::Constant(kInfinity);
  for (int k = 0; k < r.n; k += kPackSize) {
    const Pack V = pack(r.v0, k) + pack(r.v1, k) * lambda;
    const Pack L = pack(r.l0, k) + (pack(r.l1, k) + 3 * lambda) * lambda;
    const Pack here = f_of(V, L);
    put(f, k, here);
    least = least.min(here);
  }
  const double min = least.minCoeff();
  int j = 0;
  while (j + 1 < r.n && f[j] != min) ++j;
  return {min, j};
}

/// The part of the line where all volumes are positive, clipped to the reach of the ring (an open ring has no end).
std::pair<double, double> feasible(const RingOnLine& r) {
  double lo = -kInfinity, hi = kInfinity, reach2 = 0;
  for (int j = 0; j < r.n; ++j) {
    const double zero = -r.v0[j] / r.v1[j];
    if (r.v1[j] > 0) lo = std::max(lo, zero);
    if (r.v1[j] < 0) hi = std::min(hi, zero);
    reach2 = std::max(reach2, r.l0[j]);
  }
  const double reach = std::sqrt(reach2);
  return {std::max(lo, -reach), std::min(hi, reach)};
}

MaxMinResult golden_section(const RingOnLine& r) {
  constexpr double kRatio = .6180339887498949;
  const double at_zero = lowest(r, 0).f;
  MaxMinResult result{0, at_zero, at_zero, 1};
  if (!(at_zero > 0)) return result;
  auto [a, b] = feasible(r);
  double x1 = b - kRatio * (b - a), x2 = a + kRatio * (b - a);
  double f1 = lowest(r, x1).f, f2 = lowest(r, x2).f;
  for (int step = 0; step < kGoldenSteps; ++step) {
    if (f1 > f2) {
      b = x2, x2 = x1, f2 = f1;
      x1 = b - kRatio * (b - a), f1 = lowest(r, x1).f;
    } else {
      a = x1, x1 = x2, f1 = f2;
      x2 = a + kRatio * (b - a), f2 = lowest(r, x2).f;
    }
  }
  result.evaluations += 2 + kGoldenSteps;
  const double best = std::max(f1, f2);
  if (best > result.f) result.lambda = f1 > f2 ? x1 : x2, result.f = best;
  return result;
}

#ifdef UMTET_WITH_GSL

// Every probe replaces a tet of the pair by one strictly lower; more than a few is rare, and this many means rounding.
constexpr int kMaxProbes = 60;
// The pair is the ring's minimum at a probe if no other tet is lower by more than rounding.
constexpr double kTie = 1e-13;

double f_of(double V, double L) { return V * std::abs(V) / (L * L * L); }

double volume(const RingOnLine& r, int j, double lambda) { return r.v0[j] + r.v1[j] * lambda; }

double length2(const RingOnLine& r, int j, double lambda) { return r.l0[j] + (r.l1[j] + 3 * lambda) * lambda; }

double f_of(const RingOnLine& r, int j, double lambda) { return f_of(volume(r, j, lambda), length2(r, j, lambda)); }

/// Sign of f_j' where V_j > 0, from 2 V' L - 3 V L'; elsewhere the direction in which the volume grows.
double slope(const RingOnLine& r, int j, double lambda) {
  const double V = volume(r, j, lambda);
  if (V <= 0) return r.v1[j];
  return 2 * r.v1[j] * length2(r, j, lambda) - 3 * V * (r.l1[j] + 6 * lambda);
}

/// Where f_j is greatest: the root of the quadratic 2 V' L - 3 V L' on the side where V > 0.
double maximiser(const RingOnLine& r, int j) {
  const double v0 = r.v0[j], v1 = r.v1[j], l0 = r.l0[j], l1 = r.l1[j];
  const double a = -12 * v1, b = -(v1 * l1 + 18 * v0), c = 2 * v1 * l0 - 3 * v0 * l1;
  const double root = std::sqrt(std::max(0., b * b - 4 * a * c));
  // Vieta's other root without cancellation. The slope falls through zero at the wanted root: 2 a s + b = -root < 0.
  return b < 0 ? 2 * c / (root - b) : (-b - root) / (2 * a);
}

/// The crossing of a rising and a falling f on [lo, hi], where V >= 0 for both.
double crossing(const RingOnLine& r, int rising, int falling, double lo, double hi) {
  // In s = (lambda - lo) / (hi - lo) and relative to the values at lo, all coefficients have a common size.
  const double w = hi - lo;
  const double Lj = length2(r, falling, lo), Vj = volume(r, falling, lo);
  const std::array<double, 2> vi = {volume(r, rising, lo) / Vj, r.v1[rising] * w / Vj},
                              vj = {1, r.v1[falling] * w / Vj};
  const auto quadratic = [&](int j, double scale) {
    return std::array<double, 3>{length2(r, j, lo) / scale, (r.l1[j] + 6 * lo) * w / scale, 3 * w * w / scale};
  };
  const std::array<double, 3> li = quadratic(rising, Lj), lj = quadratic(falling, Lj);
  // V^2 M^3 of degree 8
  const auto product = [](const std::array<double, 2>& v, const std::array<double, 3>& m) {
    const std::array<double, 3> v2 = {v[0] * v[0], 2 * v[0] * v[1], v[1] * v[1]};
    std::array<double, 5> m2{};
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) m2[p + q] += m[p] * m[q];
    }
    std::array<double, 5> vm{};
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) vm[p + q] += v2[p] * m[q];
    }
    std::array<double, kMaxDegree + 1> c{};
    for (int p = 0; p < 5; ++p) {
      for (int q = 0; q < 5; ++q) c[p + q] += m2[p] * vm[q];
    }
    return c;
  };
  std::array<double, kMaxDegree + 1> c = product(vi, lj);
  const std::array<double, kMaxDegree + 1> d = product(vj, li);
  for (int k = 0; k <= kMaxDegree; ++k) c[k] -= d[k];
  return lo + w * bracketed_root(c, 0, 1);
}

/// The bracket and the tets that bound it: `rising` is the lowest at lo, `falling` at hi; -1 where none is known yet.
struct Pair {
  double lo = -kInfinity, hi = kInfinity;
  int rising = -1, falling = -1;
};

/// argmax of min(f_rising, f_falling) within the bracket.
double best_of_pair(const RingOnLine& r, const Pair& p) {
  if (p.falling < 0) return maximiser(r, p.rising);
  if (p.rising < 0) return maximiser(r, p.falling);
  const double mi = maximiser(r, p.rising), mj = maximiser(r, p.falling);
  if (mi < p.hi && f_of(r, p.rising, mi) <= f_of(r, p.falling, mi)) return mi;
  if (mj > p.lo && f_of(r, p.falling, mj) <= f_of(r, p.rising, mj)) return mj;
  // Each is above the other at its own maximum: they cross in between, and if the maxima are the other way round than
  // the names say, it is the rising one that falls there.
  if (mi < mj) return crossing(r, p.falling, p.rising, mi, mj);
  double lo = std::max(p.lo, mj), hi = std::min(p.hi, mi);
  for (const int j : {p.rising, p.falling}) {  // a bracket end found at an inverted tet lies beyond its zero volume
    const double zero = -r.v0[j] / r.v1[j];
    if (r.v1[j] > 0) lo = std::max(lo, zero);
    if (r.v1[j] < 0) hi = std::min(hi, zero);
  }
  return lo < hi ? crossing(r, p.rising, p.falling, lo, hi) : .5 * (p.lo + p.hi);
}

MaxMinResult exact(const RingOnLine& r) {
  Probe probe = lowest(r, 0);
  MaxMinResult result{0, probe.f, probe.f, 1};
  if (!(probe.f > 0)) return result;
  Pair pair;
  double lambda = 0;
  for (int step = 0; step < kMaxProbes; ++step) {
    const double s = slope(r, probe.tet, lambda);
    if (s == 0) break;
    if (s > 0) {
      pair.lo = lambda, pair.rising = probe.tet;
    } else {
      pair.hi = lambda, pair.falling = probe.tet;
    }
    const double next = best_of_pair(r, pair);
    if (!(next > pair.lo && next < pair.hi)) break;  // the bracket has shrunk to rounding
    probe = lowest(r, next);
    ++result.evaluations;
    if (probe.f > result.f) result.lambda = next, result.f = probe.f;
    double active = kInfinity;
    if (pair.rising >= 0) active = f_of(r, pair.rising, next);
    if (pair.falling >= 0) active = std::min(active, f_of(r, pair.falling, next));
    if (probe.f >= active * (1 - kTie)) break;
    lambda = next;
  }
  return result;
}

#else

MaxMinResult exact(const RingOnLine&) { throw std::logic_error("max_min: built without GSL, Exact is not available"); }

#endif

}  // namespace

OneRing::OneRing(const Vec3& x, std::span<const Vec3> V, std::span<const Triangle> faces)
    : n(static_cast<int>(faces.size())) {
  const Pack X = Pack::Constant(x.x()), Y = Pack::Constant(x.y()), Z = Pack::Constant(x.z());
  Pack least = Pack::Constant(kInfinity);
  for (int k = 0; k < n; k += kPackSize) {
    std::array<const Vec3*, kPackSize> p, q, r;
    for (int m = 0; m < kPackSize; ++m) {
      const Triangle& face = faces[std::min(k + m, n - 1)];
      p[m] = &V[face[0]], q[m] = &V[face[1]], r[m] = &V[face[2]];
    }
    const auto component = [](const std::array<const Vec3*, kPackSize>& a, int c) {
      return Pack((*a[0])[c], (*a[1])[c], (*a[2])[c], (*a[3])[c]);
    };
    const Pack ax = component(p, 0) - X, ay = component(p, 1) - Y, az = component(p, 2) - Z;
    const Pack bx = component(q, 0) - X, by = component(q, 1) - Y, bz = component(q, 2) - Z;
    const Pack cx = component(r, 0) - X, cy = component(r, 1) - Y, cz = component(r, 2) - Z;
    const Pack ux = bx - ax, uy = by - ay, uz = bz - az, wx = cx - ax, wy = cy - ay, wz = cz - az;
    const Pack Nx = uy * wz - uz * wy, Ny = uz * wx - ux * wz, Nz = ux * wy - uy * wx;
    const Pack Sx = ax + bx + cx, Sy = ay + by + cy, Sz = az + bz + cz;
    const Pack spokes = ax * ax + ay * ay + az * az + bx * bx + by * by + bz * bz + cx * cx + cy * cy + cz * cz;
    put(nx, k, Nx), put(ny, k, Ny), put(nz, k, Nz);
    const Pack V0 = Nx * ax + Ny * ay + Nz * az;
    put(v, k, V0);
    put(sx, k, -2 * Sx), put(sy, k, -2 * Sy), put(sz, k, -2 * Sz);
    // |a|^2 + |b|^2 + |c|^2 and the face's |a - b|^2 + |b - c|^2 + |c - a|^2 = 3 (...) - |a + b + c|^2
    const Pack L0 = 4 * spokes - (Sx * Sx + Sy * Sy + Sz * Sz);
    put(l, k, L0);
    least = least.min(f_of(V0, L0));
  }
  f_here = least.minCoeff();
}

double OneRing::min_f(const Vec3& y) const {
  Pack least = Pack::Constant(kInfinity);
  const double y2 = 3 * y.squaredNorm();
  for (int k = 0; k < n; k += kPackSize) {
    const Pack V = pack(v, k) - (pack(nx, k) * y.x() + pack(ny, k) * y.y() + pack(nz, k) * y.z());
    const Pack L = pack(l, k) + (pack(sx, k) * y.x() + pack(sy, k) * y.y() + pack(sz, k) * y.z()) + y2;
    least = least.min(f_of(V, L));
  }
  return least.minCoeff();
}

RingOnLine::RingOnLine(const OneRing& ring, const Vec3& d) : n(ring.n) {
  for (int k = 0; k < n; k += kPackSize) {
    put(v0, k, pack(ring.v, k));
    put(v1, k, -(pack(ring.nx, k) * d.x() + pack(ring.ny, k) * d.y() + pack(ring.nz, k) * d.z()));
    put(l0, k, pack(ring.l, k));
    put(l1, k, pack(ring.sx, k) * d.x() + pack(ring.sy, k) * d.y() + pack(ring.sz, k) * d.z());
  }
}

double quality_of(double f) { return kMeanRatioFactor * std::cbrt(f); }

double f_of_quality(double Q) {
  const double root = Q / kMeanRatioFactor;
  return root * root * root;
}

MaxMinResult max_min(const RingOnLine& ring, MaxMin method) {
  return method == MaxMin::Exact ? exact(ring) : golden_section(ring);
}

}  // namespace umtet
