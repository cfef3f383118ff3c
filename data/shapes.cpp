#include "data/shapes.h"

namespace umtet {
namespace {

/// Smooth minimum (a + b - sqrt((a - b)^2 + k^2)) / 2: below both, by k / 2 where they are equal; C-infinity.
Dual join(const Dual& a, const Dual& b, double k) { return 0.5 * (a + b - sqrt(square(a - b) + k * k)); }

/// To first order the distance to the ellipsoid of semi-axes a, b, c along x, y, z: (q - 1) / |grad q|.
Dual ellipsoid(const Dual& x, const Dual& y, const Dual& z, double a, double b, double c) {
  const Dual q = square(x / a) + square(y / b) + square(z / c);
  // |grad q|^2 / 4, kept from 0 at the centre, where q - 1 is far from 0 anyway.
  const Dual slope2 = square(x / (a * a)) + square(y / (b * b)) + square(z / (c * c)) + 0.1 / (a * a);
  return (q - 1.0) / (2.0 * sqrt(slope2));
}

/// Ring of radii R and r, axis y. The 0.02 keeps the root smooth on the axis and shrinks R by 0.01 / R.
Dual ring(const Dual& x, const Dual& y, const Dual& z, double R, double r) {
  const Dual rho = sqrt(square(x) + square(z) + 0.02 * R * R);
  return sqrt(square(rho - R) + square(y) + 1e-3 * r * r) - r;
}

/// A plate in the plane y = 0, all its edges round with radius r: the points closer than r to its outline.
/// @param s      distance to the outline in the plane, negative inside
/// @param width  of the outline, for how soon inside is flat
Dual plate(const Dual& s, const Dual& y, double width, double r) {
  const Dual outside = 0.5 * (s + sqrt(square(s) + 0.01 * width * width));  // s where positive, else about 0
  return sqrt(square(outside) + square(y)) - r;
}

/// Outline q = (x / a)^6 + (z / c)^2 < 1 of a pair of wings, its chord c a fifth shorter at the tips: (q - 1) / |grad
/// q|. An ellipse would do but for its pointed tips, where that quotient is a poor distance.
Dual wing_outline(const Dual& x, const Dual& z, double a, double chord) {
  const Dual c = chord * (1.0 - 0.2 * square(x / a));
  const Dual x2 = square(x / a), x4 = square(x2);
  const Dual q = x4 * x2 + square(z / c);
  const Dual half_slope2 = square(3.0 * x4 * x / (a * a)) + square(z / square(c)) + 0.1 / (a * a);
  return (q - 1.0) / (2.0 * sqrt(half_slope2));
}

}  // namespace

Dual duck(const Dual& x, const Dual& y, const Dual& z) {
  const Dual swim_ring = ring(x, y, z, 0.51, 0.225);
  const Dual neck = ellipsoid(x - 0.5, y - 0.2, z, 0.19, 0.3, 0.19);
  const Dual head = ellipsoid(x - 0.54, y - 0.47, z, 0.26, 0.24, 0.24);
  const Dual beak = ellipsoid(x - 0.83, y - 0.43, z, 0.2, 0.12, 0.17);
  // The tail points up and back: axes turned by the 3-4-5 triangle.
  const Dual tail_x = x + 0.66, tail_y = y - 0.15;
  const Dual tail = ellipsoid(0.8 * tail_x + 0.6 * tail_y, 0.8 * tail_y - 0.6 * tail_x, z, 0.14, 0.25, 0.18);
  return join(join(join(join(swim_ring, neck, 0.1), head, 0.1), beak, 0.08), tail, 0.1);
}

Dual bird(const Dual& x, const Dual& y, const Dual& z) {
  const Dual body = ellipsoid(x, y, z, 0.29, 0.26, 0.8);
  const Dual head = ellipsoid(x, y - 0.1, z - 0.82, 0.21, 0.21, 0.23);
  const Dual beak = ellipsoid(x, y - 0.06, z - 1.08, 0.11, 0.1, 0.2);
  const Dual swept = z - 0.25 + 0.12 * square(x);
  const Dual wings = plate(wing_outline(x, swept, 1.84, 0.3), y - 0.05, 0.3, 0.13);
  const Dual tail = plate(ellipsoid(x, 0.0, z + 0.95, 0.28, 1.0, 0.22), y - 0.02, 0.22, 0.11);
  return join(join(join(join(body, wings, 0.1), head, 0.1), tail, 0.1), beak, 0.06);
}

Dual knot(const Dual& x, const Dual& y, const Dual& z) {
  return join(join(ring(x, y, z, 1.0, 0.14), ring(y, z, x, 1.0, 0.14), 0.08), ring(z, x, y, 1.0, 0.14), 0.08);
}

Dual torus(const Dual& x, const Dual& y, const Dual& z) {
  const Dual rho = sqrt(square(x) + square(y));
  return sqrt(square(rho - 1.0) + square(z)) - 0.4;
}

Dual blob(const Dual& x, const Dual& y, const Dual& z) {
  const Dual thick = ellipsoid(x + 0.4, y, z, 0.6, 0.55, 0.5);
  const Dual thin = ellipsoid(x - 0.45, y - 0.1, z + 0.05, 0.55, 0.32, 0.35);
  return join(thick, thin, 0.25);
}

}  // namespace umtet
