#pragma once

#include <stdexcept>

#include "tests/support/domains.h"

namespace umtet::testing {

/// The Chebyshev polynomials of degree 6 and 8 as Banchoff-Chmutov surfaces, genus 28 and 81.
inline AnalyticDomain banchoff_chmutov_6() {
  return {
      "banchoff_chmutov_6", cube_box(1.05), 1, 28, std::nullopt, {{0, 0, 1.0242}}, [](const Vec3& x, Vec3* g, Mat3* H) {
        const Eigen::Array3d a = x.array().square();
        if (g) *g = ((192 * a - 192) * a + 36) * x.array();
        if (H) *H = ((960 * a - 576) * a + 36).matrix().asDiagonal();
        return (((32 * a - 48) * a + 18) * a - 1).sum();
      }};
}
inline AnalyticDomain banchoff_chmutov_8() {
  return {"banchoff_chmutov_8",
          cube_box(1.04),
          1,
          81,
          std::nullopt,
          {{.9239, .9239, 1.0136}},
          [](const Vec3& x, Vec3* g, Mat3* H) {
            const Eigen::Array3d a = x.array().square();
            if (g) *g = (((1024 * a - 1536) * a + 640) * a - 64) * x.array();
            if (H) *H = (((7168 * a - 7680) * a + 1920) * a - 64).matrix().asDiagonal();
            return ((((128 * a - 256) * a + 160) * a - 32) * a + 1).sum();
          }};
}

/// A plate with m x n holes, genus m n: c_m(x) + c_n(y) + 16 z^2 = 1, where c_m is a cosine of period one with m maxima
/// (the holes) between its outermost minima, and the parabola that joins it with three derivatives beyond them.
inline AnalyticDomain perforated_plate(int m, int n) {
  const double a = .5 * m, b = .5 * n;
  const auto wave = [](double x, double end, double sign, double* d, double* dd) {
    const double w = 2 * std::numbers::pi, over = std::abs(x) - end;
    if (over > 0) {
      if (d) *d = w * w * std::copysign(over, x);
      if (dd) *dd = w * w;
      return .5 * w * w * over * over - 1;
    }
    if (d) *d = -sign * w * std::sin(w * x);
    if (dd) *dd = -sign * w * w * std::cos(w * x);
    return sign * std::cos(w * x);
  };
  // A hole is at x = 0 for odd m, half a period away for even m.
  const double sx = m % 2 == 1 ? 1 : -1, sy = n % 2 == 1 ? 1 : -1;
  return {"plate_" + std::to_string(m * n),
          Box(Vec3(-a - .4, -b - .4, -.5), Vec3(a + .4, b + .4, .5)),
          1,
          m * n,
          std::nullopt,
          {{m % 2 == 1 ? .5 : 0, n % 2 == 1 ? .5 : 0, .433}},
          [=](const Vec3& x, Vec3* g, Mat3* H) {
            double dx, dy, dxx, dyy;
            const double f = wave(x.x(), a, sx, &dx, &dxx) + wave(x.y(), b, sy, &dy, &dyy) + 16 * x.z() * x.z() - 1;
            if (g) *g = Vec3(dx, dy, 32 * x.z());
            if (H) *H = Vec3(dxx, dyy, 32).asDiagonal();
            return f;
          }};
}

/// The shapes of the comparison with other meshers, then those of Figure 18 by genus.
/// \throw std::invalid_argument for an unknown name
inline AnalyticDomain domain_by_name(const std::string& name) {
  if (name == "sphere") return sphere();
  if (name == "torus") return torus();
  if (name == "equation_9") return equation_9();
  if (name == "banchoff_chmutov_6") return banchoff_chmutov_6();
  if (name == "equation_13") return equation_13(3.2);
  if (name == "plate_3") return perforated_plate(3, 1);
  if (name == "plate_18") return perforated_plate(6, 3);
  if (name == "banchoff_chmutov_8") return banchoff_chmutov_8();
  throw std::invalid_argument(name + ": no such shape");
}

}  // namespace umtet::testing
