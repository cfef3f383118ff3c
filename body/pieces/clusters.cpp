#include "body/pieces/clusters.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "common/disjoint_sets.h"

namespace umtet {

std::vector<int> clusters(const std::vector<Vec3>& x, double size) {
  using Key = std::array<std::int64_t, 3>;
  std::vector<std::pair<Key, int>> cubes;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Array3d q = (x[i] / size).array().floor();
    cubes.push_back(
        {{static_cast<std::int64_t>(q[0]), static_cast<std::int64_t>(q[1]), static_cast<std::int64_t>(q[2])},
         static_cast<int>(i)});
  }
  std::sort(cubes.begin(), cubes.end());
  DisjointSets sets(x.size());
  for (const auto& [key, i] : cubes) {
    for (int n = 0; n < 27; ++n) {
      const Key next = {key[0] + n % 3 - 1, key[1] + n / 3 % 3 - 1, key[2] + n / 9 - 1};
      // The first point of a cube stands for all of them: each is joined to its own cube's first.
      const auto at = std::lower_bound(cubes.begin(), cubes.end(), std::pair(next, 0));
      if (at != cubes.end() && at->first == next) sets.unite(i, at->second);
    }
  }
  std::vector<int> set(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) set[i] = sets.find(static_cast<int>(i));
  return set;
}

std::vector<std::vector<int>> members_of(const std::vector<int>& set) {
  std::vector<int> rank(set.size(), -1);
  std::vector<std::vector<int>> members;
  for (std::size_t i = 0; i < set.size(); ++i) {
    int& at = rank[static_cast<std::size_t>(set[i])];
    if (at < 0) {
      at = static_cast<int>(members.size());
      members.emplace_back();
    }
    members[static_cast<std::size_t>(at)].push_back(static_cast<int>(i));
  }
  return members;
}

}  // namespace umtet
