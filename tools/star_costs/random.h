#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <numbers>

#include "common/vec3.h"

namespace umtet::star_costs {

/// SplitMix64: the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  double in(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }
  Vec3 point(double half) {
    const double x = in(-half, half), y = in(-half, half), z = in(-half, half);
    return {x, y, z};
  }
  Mat3 rotation() {
    const double angle = in(0, 2 * std::numbers::pi);
    Vec3 axis = point(1);
    while (axis.squaredNorm() > 1 || axis.squaredNorm() < .01) axis = point(1);
    return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  }

 private:
  std::uint64_t state_;
};

}  // namespace umtet::star_costs
