#include "reconstruct/cloud/local_noise.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace umtet {
namespace {

// As many neighbours as areas are taken from; and samples that are looked at first.
constexpr std::size_t kNeighbours = 12, kPicked = 5000;
// Cosine of 26 degrees: more is an edge.
constexpr double kAlike = .9;
// Offsets of half a spacing are unusual; less than a hundredth of the samples are edges and creases.
constexpr double kTimesUsual = 2, kOfReach = .2, kLeastShare = .01;

struct Scatter {
  double noise = 0, reach = 0;  ///< reach: distance of the farthest of the neighbours
};

Scatter scatter(const OrientedPointCloud& cloud, const NeighbourTree& tree, std::uint32_t i) {
  std::array<Neighbour, kNeighbours + 1> room;
  double sum = 0, farthest2 = 0;
  int n = 0;
  for (const Neighbour& other : tree.k_nearest(cloud.points[i], room)) {
    farthest2 = std::max(farthest2, other.distance2);
    const Vec3 &a = cloud.normals[i], &b = cloud.normals[other.point];
    if (other.point == i || a.dot(b) < kAlike) continue;
    const double defect = (a + b).dot(cloud.points[other.point] - cloud.points[i]) / 2;
    sum += defect * defect / 2;
    ++n;
  }
  return {n > 0 ? std::sqrt(sum / n) : 0, std::sqrt(farthest2)};
}

}  // namespace

std::vector<double> local_noise(const OrientedPointCloud& cloud, const NeighbourTree& tree, double usual) {
  const std::size_t n = cloud.points.size(), stride = std::max<std::size_t>(1, n / kPicked), n_picked = n / stride;
  std::vector<std::uint8_t> is_unusual(n_picked);
  tbb::parallel_for(std::size_t{0}, n_picked, [&](std::size_t p) {
    const Scatter s = scatter(cloud, tree, tree.order()[p * stride]);
    is_unusual[p] = s.noise > std::max(kTimesUsual * usual, kOfReach * s.reach) ? 1 : 0;
  });
  const auto n_unusual = static_cast<double>(std::count(is_unusual.begin(), is_unusual.end(), 1));
  if (n_unusual < kLeastShare * static_cast<double>(n_picked)) return {};
  std::vector<double> single(n), local(n);
  tbb::parallel_for(std::size_t{0}, n,
                    [&](std::size_t i) { single[i] = scatter(cloud, tree, static_cast<std::uint32_t>(i)).noise; });
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    std::array<Neighbour, kNeighbours + 1> room;
    std::array<double, kNeighbours + 1> around;
    std::size_t k = 0;
    for (const Neighbour& other : tree.k_nearest(cloud.points[i], room)) around[k++] = single[other.point];
    std::nth_element(around.begin(), around.begin() + k / 2, around.begin() + k);
    local[i] = std::max(usual, around[k / 2]);
  });
  return local;
}

}  // namespace umtet
