#include "mesh/octree/balanced_octree.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "mesh/octree/octree_grid.h"

namespace umtet {
namespace {

/// Split cubes of every level, sorted.
using SplitCubes = std::vector<std::vector<std::uint64_t>>;

std::uint64_t child(std::uint64_t corner, int level, std::uint64_t octant) {
  return cube_key(corner | octant << half_width_shift(level), level + 1);
}

/// The items of those that pass, in order. Tests run by all threads.
template <class F>
std::vector<std::uint64_t> filtered(const std::vector<std::uint64_t>& items, const F& test) {
  std::vector<std::uint8_t> passes(items.size());
  tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) { passes[i] = test(items[i]); });
  std::vector<std::uint64_t> kept;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (passes[i]) kept.push_back(items[i]);
  }
  return kept;
}

SplitCubes asked_for(const OctreeRules& rules) {
  SplitCubes split;
  std::vector<std::uint64_t> cubes = {cube_key(0, 0)};
  std::size_t n_leaves = 1;
  for (int level = 0; level < rules.max_level && !cubes.empty(); ++level) {
    split.push_back(filtered(
        cubes, [&](std::uint64_t cube) { return (!rules.wanted || rules.wanted(cube)) && rules.splits(cube); }));
    n_leaves += 7 * split.back().size();
    if (n_leaves > rules.max_leaves)
      throw std::length_error("more than " + std::to_string(rules.max_leaves) + " leaves");
    cubes.clear();
    for (const std::uint64_t cube : split.back()) {
      for (std::uint64_t octant = 0; octant < 8; ++octant) cubes.push_back(child(cube_corner(cube), level, octant));
    }
  }
  while (!split.empty() && split.back().empty()) split.pop_back();
  return split;
}

void sort_unique(std::vector<std::uint64_t>& cubes) {
  tbb::parallel_sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
}

/// The parents of a split cube and of its neighbours, which all must be split: on each axis its own, and the one beyond
/// the side of the parent that it is at.
void add_parents(std::uint64_t cube, int level, std::vector<std::uint64_t>& parents) {
  const GridPoint corner = grid_point(cube_corner(cube));
  const std::int32_t w = width(level - 1);
  for (int beyond = 0; beyond < 8; ++beyond) {
    GridPoint parent;
    bool exists = true;
    for (int a = 0; a < 3; ++a) {
      parent[a] = corner[a] & ~(w - 1);
      if (beyond >> a & 1) parent[a] += corner[a] & w >> 1 ? w : -w;
      exists &= parent[a] >= 0 && parent[a] < kRootWidth;
    }
    if (exists) parents.push_back(cube_key(morton_key(parent), level - 1));
  }
}

void balance(SplitCubes& split, std::size_t max_leaves) {
  std::size_t n_leaves = 1;
  std::vector<std::uint64_t> parents;
  for (std::size_t level = split.size(); level-- > 0;) {
    n_leaves += 7 * split[level].size();
    if (n_leaves > max_leaves) throw std::length_error("more than " + std::to_string(max_leaves) + " leaves");
    if (level == 0) break;
    parents.clear();
    for (const std::uint64_t cube : split[level]) add_parents(cube, static_cast<int>(level), parents);
    auto& coarser = split[level - 1];
    coarser.insert(coarser.end(), parents.begin(), parents.end());
    sort_unique(coarser);
  }
}

}  // namespace

std::vector<std::uint64_t> balanced_octree(const OctreeRules& rules) {
  SplitCubes split = asked_for(rules);
  if (split.empty()) return {cube_key(0, 0)};
  balance(split, rules.max_leaves);
  std::vector<std::uint64_t> leaves;
  for (std::size_t level = 0; level < split.size(); ++level) {
    const auto& parents = rules.wanted ? filtered(split[level], rules.wanted) : split[level];
    auto finer = level + 1 < split.size() ? split[level + 1].begin() : split[level].end();
    const auto end = level + 1 < split.size() ? split[level + 1].end() : split[level].end();
    for (const std::uint64_t parent : parents) {
      for (std::uint64_t octant = 0; octant < 8; ++octant) {
        const std::uint64_t cube = child(cube_corner(parent), static_cast<int>(level), octant);
        while (finer != end && *finer < cube) ++finer;
        if (finer == end || *finer != cube) leaves.push_back(cube);
      }
    }
  }
  tbb::parallel_sort(leaves.begin(), leaves.end());
  return leaves;
}

}  // namespace umtet
