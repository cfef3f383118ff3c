#include "reconstruct/cloud/survey/local_noise.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"

namespace umtet {
namespace {

// As many neighbours as areas are taken from; and samples that are looked at first.
constexpr std::size_t kNeighbours = 12, kPicked = 5000;
// Cosine of 26 degrees: more is an edge.
constexpr double kAlike = .9;
// Offsets of half a spacing are unusual; less than a hundredth of the samples are edges and creases.
constexpr double kTimesUsual = 2, kOfReach = .2, kLeastShare = .01;

/// Standard deviation of a sample and its neighbours along the normals, the rms of their defects over sqrt 2.
double scatter(const OrientedPointCloud& cloud, std::uint32_t i, std::span<const std::uint32_t> neighbours) {
  double sum = 0;
  int n = 0;
  for (const std::uint32_t j : neighbours) {
    const Vec3 &a = cloud.normals[i], &b = cloud.normals[j];
    if (j == i || a.dot(b) < kAlike) continue;
    const double defect = (a + b).dot(cloud.points[j] - cloud.points[i]) / 2;
    sum += defect * defect / 2;
    ++n;
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

bool is_unusual(const OrientedPointCloud& cloud, const NeighbourTree& tree, std::uint32_t i, double usual) {
  std::array<Neighbour, kNeighbours + 1> room;
  std::array<std::uint32_t, kNeighbours + 1> neighbours;
  const std::span<const Neighbour> near = tree.k_nearest(cloud.points[i], room);
  for (std::size_t k = 0; k < near.size(); ++k) neighbours[k] = near[k].point;
  const double reach = std::sqrt(near.back().distance2);
  return scatter(cloud, i, {neighbours.data(), near.size()}) > std::max(kTimesUsual * usual, kOfReach * reach);
}

}  // namespace

std::vector<double> local_noise(const OrientedPointCloud& cloud, const NeighbourTree& tree, double usual) {
  const std::size_t n = cloud.points.size(), stride = std::max<std::size_t>(1, n / kPicked), n_picked = n / stride;
  std::vector<std::uint8_t> unusual(n_picked);
  tbb::parallel_for(std::size_t{0}, n_picked, [&](std::size_t p) {
    unusual[p] = is_unusual(cloud, tree, tree.order()[p * stride], usual) ? 1 : 0;
  });
  const auto n_unusual = static_cast<double>(std::count(unusual.begin(), unusual.end(), 1));
  if (n_unusual < kLeastShare * static_cast<double>(n_picked)) return {};
  const Neighbourhoods near(tree, kNeighbours);
  std::vector<double> single(n), local(n);
  tbb::parallel_for(std::size_t{0}, n,
                    [&](std::size_t i) { single[i] = scatter(cloud, static_cast<std::uint32_t>(i), near.points(i)); });
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    std::array<double, kNeighbours + 1> around;
    std::size_t k = 0;
    around[k++] = single[i];
    for (const std::uint32_t j : near.points(i)) around[k++] = single[j];
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(k / 2);
    std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(k));
    local[i] = std::max(usual, *middle);
  });
  return local;
}

}  // namespace umtet
