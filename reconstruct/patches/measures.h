#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/vec3.h"

namespace umtet {

inline constexpr double kDegree = std::numbers::pi / 180;  ///< radians

/// The angle between two unit vectors, radians; accurate near 0, too.
inline double angle_between(const Vec3& a, const Vec3& b) { return 2 * std::asin(std::min(1.0, .5 * (a - b).norm())); }

/// The upper median. \pre there is a value
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace umtet
