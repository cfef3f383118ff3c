#include "tools/star_costs/random_shape.h"

#include <cmath>
#include <numbers>

#include "tools/star_costs/random.h"

namespace umtet::star_costs {

RandomShape::RandomShape(std::uint64_t seed) : family_(static_cast<Family>(seed % 3)) {
  Random random(seed);
  rotation_ = random.rotation();
  centre_ = random.point(.5);
  double reach = 0;
  switch (family_) {
    case Family::Waves:
      // Features stay above an eighth of the body: |k| <= 4, amplitudes falling with |k|^2.
      for (int i = 0; i < 6; ++i) {
        const Vec3 k = random.point(2.5);
        waves_.push_back({k, random.in(0, 2 * std::numbers::pi), random.in(.05, .4) / (1 + .3 * k.squaredNorm())});
        reach += waves_.back().amplitude;
      }
      reach = std::sqrt(1 + reach);
      break;
    case Family::Blobs:
      for (int i = 0; i < 5; ++i) {
        blobs_.push_back({random.point(.7), random.in(.45, .8)});
        reach = std::max(reach, blobs_.back().centre.norm());
      }
      reach += .8 * std::sqrt(std::log(2. * 5));  // where the sum cannot reach 1/2
      break;
    case Family::Superquadric:
      axes_ = Vec3(random.in(.7, 1), random.in(.6, 1), random.in(.45, .8));
      exponent_ = random.in(2.4, 4);
      reach = axes_.norm();
      break;
  }
  box_ = Box(centre_ - Vec3::Constant(reach), centre_ + Vec3::Constant(reach));
}

double RandomShape::evaluate(const Vec3& at, Vec3* g, Mat3* H) const {
  const Vec3 x = rotation_ * (at - centre_);
  Vec3 gradient = Vec3::Zero();
  Mat3 hessian = Mat3::Zero();
  double value = 0;
  switch (family_) {
    case Family::Waves:
      value = x.squaredNorm() - 1;
      gradient = 2 * x;
      hessian = 2 * Mat3::Identity();
      for (const Wave& w : waves_) {
        const double phase = w.k.dot(x) + w.phase, s = w.amplitude * std::sin(phase);
        value += s;
        gradient += w.amplitude * std::cos(phase) * w.k;
        hessian -= s * w.k * w.k.transpose();
      }
      break;
    case Family::Blobs:
      value = .5;
      for (const Blob& b : blobs_) {
        const Vec3 d = x - b.centre;
        const double w2 = b.width * b.width, e = std::exp(-d.squaredNorm() / w2);
        value -= e;
        gradient += 2 * e / w2 * d;
        hessian += e * (2 / w2 * Mat3::Identity() - 4 / (w2 * w2) * d * d.transpose());
      }
      break;
    case Family::Superquadric:
      value = -1;
      for (int a = 0; a < 3; ++a) {
        const double u = std::abs(x[a]) / axes_[a], sign = x[a] < 0 ? -1 : 1;
        value += std::pow(u, exponent_);
        gradient[a] = sign * exponent_ * std::pow(u, exponent_ - 1) / axes_[a];
        hessian(a, a) = exponent_ * (exponent_ - 1) * std::pow(u, exponent_ - 2) / (axes_[a] * axes_[a]);
      }
      break;
  }
  if (g) *g = rotation_.transpose() * gradient;
  if (H) *H = rotation_.transpose() * hessian * rotation_;
  return value;
}

}  // namespace umtet::star_costs
