#include "reconstruct/cloud/normals/lines_of_sight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/cloud/neighbours/local_quadric.h"

namespace umtet {
namespace {

constexpr double kDegree = std::numbers::pi / 180;  // unit
constexpr std::size_t kProbes = 1000;               // which fix the median angle to 3 % of the range of angles
constexpr double kLargestDoubt = 5 * kDegree;       // a quarter of the angle that is looked for
// A scanner afar sees a ball at 45 degrees in the median: less than half of that.
constexpr double kFarthestNormal = 20 * kDegree;

}  // namespace

bool are_lines_of_sight(const OrientedPointCloud& cloud, const Neighbourhoods& near, const Covering& covering) {
  const std::size_t n = cloud.points.size();
  if (cloud.normals.size() != n || near.size() != n)
    throw std::invalid_argument(
        formatted("%zu points, %zu normals, neighbours of %zu: must be equal", n, cloud.normals.size(), near.size()));
  const bool is_even = covering.is_even();
  const Neighbourhoods& among = is_even ? near : covering.near;
  const auto point = [&](std::size_t row) { return is_even ? row : covering.chosen[row]; };
  const std::size_t stride = std::max<std::size_t>(1, among.size() / kProbes);
  std::vector<Neighbour> neighbours(among.k());
  std::vector<double> angles;
  std::size_t n_probes = 0;
  for (std::size_t row = 0; row < among.size(); row += stride, ++n_probes) {
    const std::size_t i = point(row);
    for (std::size_t k = 0; k < among.k(); ++k) {
      const std::size_t j = point(among.points(row)[k]);
      neighbours[k] = {squared_distance(cloud.points[i], cloud.points[j]), static_cast<std::uint32_t>(j)};
    }
    const LocalQuadric quadric = local_quadric(cloud.points, cloud.points[i], neighbours);
    const double radius = std::sqrt(neighbours.back().distance2);
    const double doubt = 2 * std::sqrt(quadric.variance / static_cast<double>(neighbours.size()));
    if (quadric.normal.isZero(0) || cloud.normals[i].isZero(0) || !(doubt <= kLargestDoubt * radius)) continue;
    angles.push_back(std::acos(std::min(1., std::abs(quadric.normal.dot(cloud.normals[i])))));
  }
  if (2 * angles.size() < n_probes || angles.empty()) return false;
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::nth_element(angles.begin(), middle, angles.end());
  return *middle > kFarthestNormal;
}

}  // namespace umtet
