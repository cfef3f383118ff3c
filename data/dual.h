#pragma once

#include <cmath>

namespace umtet {

/// A value and its gradient in x, y, z, carried through arithmetic by the chain rule.
/// Only + - * / and sqrt, which IEEE 754 rounds in one way: with them the clouds have the same bytes everywhere.
struct Dual {
  double value = 0;
  double dx = 0, dy = 0, dz = 0;

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): 2 * x has to read like that
  Dual(double v, double gx, double gy, double gz) : value(v), dx(gx), dy(gy), dz(gz) {}
};

inline Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.dx + b.dx, a.dy + b.dy, a.dz + b.dz};
}
inline Dual operator-(const Dual& a, const Dual& b) {
  return {a.value - b.value, a.dx - b.dx, a.dy - b.dy, a.dz - b.dz};
}
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.dx * b.value + a.value * b.dx, a.dy * b.value + a.value * b.dy,
          a.dz * b.value + a.value * b.dz};
}
inline Dual operator/(const Dual& a, const Dual& b) {
  const double q = a.value / b.value;
  return {q, (a.dx - q * b.dx) / b.value, (a.dy - q * b.dy) / b.value, (a.dz - q * b.dz) / b.value};
}
inline Dual sqrt(const Dual& a) {
  const double root = std::sqrt(a.value), slope = 0.5 / root;
  return {root, slope * a.dx, slope * a.dy, slope * a.dz};
}
inline Dual square(const Dual& a) { return a * a; }

}  // namespace umtet
