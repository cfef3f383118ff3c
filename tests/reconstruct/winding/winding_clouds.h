#pragma once

// What the tests of the winding number share.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reconstruct/cloud/neighbours/morton_order.h"
#include "reconstruct/cloud/point_cloud.h"
#include "tests/support/clouds.h"

namespace umtet::test {

inline std::size_t n_wrong(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) wrong += normals[i].dot(truth[i]) > 0 ? 0 : 1;
  return wrong;
}

inline double rms_angle_deg(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    sum += std::pow(std::acos(std::clamp(normals[i].dot(truth[i]), -1., 1.)), 2);
  return std::sqrt(sum / static_cast<double>(truth.size())) * 180 / std::numbers::pi;
}

/// n of its samples, each farthest from those before.
inline OrientedPointCloud spread(const OrientedPointCloud& cloud, std::size_t n) {
  OrientedPointCloud few;
  std::vector<double> distance2(cloud.points.size(), 1e300);
  for (std::size_t next = 0; few.points.size() < n;) {
    few.points.push_back(cloud.points[next]);
    few.normals.push_back(cloud.normals[next]);
    for (std::size_t i = 0; i < distance2.size(); ++i)
      distance2[i] = std::min(distance2[i], (cloud.points[i] - few.points.back()).squaredNorm());
    next = static_cast<std::size_t>(std::max_element(distance2.begin(), distance2.end()) - distance2.begin());
  }
  return few;
}

inline OrientedPointCloud sorted(OrientedPointCloud cloud) {
  sort_in_space(cloud);
  return cloud;
}

/// Two sheets and their rim, a spacing apart: neighbours of a sample are on both.
inline OrientedPointCloud thin_plate(double spacing) {
  return box_cloud({40 * spacing, 40 * spacing, spacing}, spacing);
}

}  // namespace umtet::test
