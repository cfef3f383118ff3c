#include "examples/swimmer/swimmer.h"

#include <cmath>
#include <numbers>

namespace umtet {
namespace {

constexpr double kPi = std::numbers::pi;

struct Parts {
  double A, B;
  Vec3 grad_A, grad_B;
};

/// Returns A and B of eq. (14) at x, in coordinates that move with the swimmer.
Parts parts(const Vec3& x, double t) {
  const double r2 = x.x() * x.x() + x.y() * x.y(), from_bulge = x.z() - t, c = std::cos(kPi * t / 16);
  return {r2 / 2 + x.z() * x.z() / 64 - 1, r2 + from_bulge * from_bulge - 25. / 4 * c * c,
          Vec3(x.x(), x.y(), x.z() / 32), Vec3(2 * x.x(), 2 * x.y(), 2 * from_bulge)};
}

}  // namespace

double Swimmer::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const auto [A, B, grad_A, grad_B] = parts(x - z0_ * Vec3::UnitZ(), t_);
  const double dA = 1 / (1 + A * A), dB = 1 / (1 + B * B);  // of the arctangents
  if (gradient) *gradient = 2 / kPi * (dA * grad_A + dB * grad_B);
  if (hessian) {
    *hessian = 2 / kPi *
               (dA * Mat3(Vec3(1, 1, 1. / 32).asDiagonal()) - 2 * A * dA * dA * grad_A * grad_A.transpose() +
                2 * dB * Mat3::Identity() - 2 * B * dB * dB * grad_B * grad_B.transpose());
  }
  return 2 / kPi * (std::atan(A) + std::atan(B)) - 1;
}

double Swimmer::time_derivative(const Vec3& x) const {
  const Parts p = parts(x - z0_ * Vec3::UnitZ(), t_);
  const double dB_dt = -p.grad_B.z() + 25. / 4 * kPi / 16 * std::sin(kPi * t_ / 8);
  return 2 / kPi * dB_dt / (1 + p.B * p.B);
}

Vec3 Swimmer::deformation_velocity(const Vec3& x) const {
  Vec3 g;
  evaluate(x, &g, nullptr);
  return -time_derivative(x) / g.squaredNorm() * g;
}

}  // namespace umtet
