#include "reconstruct/cloud/neighbours/neighbourhoods.h"

#include <algorithm>
#include <stdexcept>

#include "common/first_touch.h"

namespace umtet {

Neighbourhoods::Neighbourhoods(const NeighbourTree& tree, std::size_t k)
    : n_(tree.size()), k_(std::min(k, tree.size() - 1)), points_(touched<std::uint32_t>(n_ * k_)) {
  if (k == 0) throw std::invalid_argument("k = 0 neighbours: must be >= 1");
  tree.for_each_neighbourhood(k_ + 1, [&](std::uint32_t i, std::span<const Neighbour> near) {
    std::size_t at = i * k_;
    const std::size_t end = at + k_;
    for (const Neighbour& other : near) {
      // Among more duplicates than k the point itself may be missing.
      if (other.point == i || at == end) continue;
      points_[at++] = other.point;
    }
  });
}

Neighbourhoods::Neighbourhoods(const std::vector<Vec3>& points, std::size_t k)
    : Neighbourhoods(NeighbourTree(points), k) {}

double Neighbourhoods::sum_of_distances2(const std::vector<Vec3>& x, std::size_t i) const {
  double sum = 0;
  for (std::size_t m = 0; m < k_; ++m) sum += distance2(x, i, m);
  return sum;
}

bool Neighbourhoods::has(std::size_t i, std::uint32_t j) const {
  const std::span<const std::uint32_t> near = points(i);
  return std::find(near.begin(), near.end(), j) != near.end();
}

}  // namespace umtet
