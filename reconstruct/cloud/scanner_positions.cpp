#include "reconstruct/cloud/scanner_positions.h"

#include <algorithm>
#include <stdexcept>

#include "common/formatted.h"

namespace umtet {

std::size_t orient_from(OrientedPointCloud& cloud, const std::vector<Vec3>& viewpoints) {
  if (cloud.normals.size() != cloud.points.size())
    throw std::invalid_argument(
        formatted("%zu points but %zu normals: must be equal", cloud.points.size(), cloud.normals.size()));
  if (viewpoints.empty()) throw std::invalid_argument("no viewpoints to orient from");
  for (const Vec3& v : viewpoints)
    if (!v.allFinite()) throw std::invalid_argument("a viewpoint is not finite");
  std::size_t n_turned = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vec3& x = cloud.points[i];
    const Vec3& nearest = *std::min_element(viewpoints.begin(), viewpoints.end(), [&](const Vec3& a, const Vec3& b) {
      return (a - x).squaredNorm() < (b - x).squaredNorm();
    });
    if (!(cloud.normals[i].dot(nearest - x) < 0)) continue;
    cloud.normals[i] = -cloud.normals[i];
    ++n_turned;
  }
  return n_turned;
}

std::size_t orient_to_origins(OrientedPointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  if (cloud.origins.size() != n || cloud.normals.size() != n)
    throw std::invalid_argument(formatted("%zu points, %zu normals, %zu origins: must be equal", n,
                                          cloud.normals.size(), cloud.origins.size()));
  std::size_t n_turned = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(cloud.normals[i].dot(cloud.origins[i] - cloud.points[i]) < 0)) continue;
    cloud.normals[i] = -cloud.normals[i];
    ++n_turned;
  }
  return n_turned;
}

}  // namespace umtet
