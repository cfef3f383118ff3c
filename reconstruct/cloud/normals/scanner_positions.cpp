#include "reconstruct/cloud/normals/scanner_positions.h"

#include <algorithm>
#include <stdexcept>

#include "common/formatted.h"

namespace umtet {
namespace {

// cos 60 degrees. A sample that is seen at a grazing angle looks away by the error of its estimated normal alone: a few
// such that are turned against their neighbours make folds of psi.
constexpr double kGrazing = .5;

/// n_i . d_i, d_i to the origin of sample i; not a number where the origin is not finite.
std::vector<double> cosines_of_sight(const OrientedPointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  if (cloud.origins.size() != n || cloud.normals.size() != n)
    throw std::invalid_argument(formatted("%zu points, %zu normals, %zu origins: must be equal", n,
                                          cloud.normals.size(), cloud.origins.size()));
  std::vector<double> cosines(n);
  for (std::size_t i = 0; i < n; ++i)
    cosines[i] = cloud.normals[i].dot((cloud.origins[i] - cloud.points[i]).normalized());
  return cosines;
}

std::size_t n_looking_away(const std::vector<double>& cosines) {
  return static_cast<std::size_t>(std::count_if(cosines.begin(), cosines.end(), [](double c) { return c < 0; }));
}

}  // namespace

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
  const std::vector<double> cosines = cosines_of_sight(cloud);
  // Estimated normals have their sides together: all of them may be wrong.
  const bool all_turn = 2 * n_looking_away(cosines) > cosines.size();
  std::size_t n_turned = 0;
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    if (all_turn ? cosines[i] > kGrazing : !(cosines[i] < -kGrazing)) continue;
    cloud.normals[i] = -cloud.normals[i];
    ++n_turned;
  }
  return n_turned;
}

double share_looking_away(const OrientedPointCloud& cloud) {
  const std::vector<double> cosines = cosines_of_sight(cloud);
  return cosines.empty() ? 0 : static_cast<double>(n_looking_away(cosines)) / static_cast<double>(cosines.size());
}

}  // namespace umtet
