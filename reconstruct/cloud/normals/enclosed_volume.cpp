#include "reconstruct/cloud/normals/enclosed_volume.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace umtet {

std::vector<EnclosedVolume> enclosed_volumes(const OrientedPointCloud& cloud, const std::vector<double>& areas,
                                             const std::vector<std::uint32_t>& component, std::size_t n_components) {
  std::vector<EnclosedVolume> bodies(n_components);
  std::vector<Vec3> centroid(n_components, Vec3::Zero()), total(n_components, Vec3::Zero());
  for (std::size_t i = 0; i < component.size(); ++i) {
    EnclosedVolume& body = bodies[component[i]];
    body.area += areas[i];
    ++body.n_points;
    // A running mean: a sum of coordinates far from the origin loses what is left of their digits.
    if (body.area > 0) centroid[component[i]] += areas[i] / body.area * (cloud.points[i] - centroid[component[i]]);
    total[component[i]] += areas[i] * cloud.normals[i];
  }
  for (std::size_t i = 0; i < component.size(); ++i)
    bodies[component[i]].volume += areas[i] / 3 * (cloud.points[i] - centroid[component[i]]).dot(cloud.normals[i]);
  for (std::size_t c = 0; c < n_components; ++c) {
    EnclosedVolume& body = bodies[c];
    if (!(body.area > 0)) continue;
    body.openness = total[c].norm() / body.area;
    body.fullness = std::abs(body.volume) * 6 * std::sqrt(std::numbers::pi) / std::pow(body.area, 1.5);
  }
  return bodies;
}

double winding_number(const OrientedPointCloud& cloud, const std::vector<double>& areas,
                      const std::vector<std::uint32_t>& members, const Vec3& x) {
  constexpr std::size_t kMostSamples = 20000;  // evenly picked: bounds the time of a winding number
  const std::size_t stride = (members.size() + kMostSamples - 1) / kMostSamples;
  double sum = 0, area = 0, area_taken = 0;
  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::uint32_t i = members[m];
    area += areas[i];
    if (m % stride != 0) continue;
    area_taken += areas[i];
    const Vec3 d = cloud.points[i] - x;
    const double distance = d.norm();
    if (distance > 0) sum += areas[i] * d.dot(cloud.normals[i]) / (distance * distance * distance);
  }
  return area_taken > 0 ? sum * area / (area_taken * 4 * std::numbers::pi) : 0;
}

}  // namespace umtet
