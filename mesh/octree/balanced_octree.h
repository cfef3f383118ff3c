#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace umtet {

/// Rules that define an octree. Several threads call both functions at once, level by level, with the cube_key() of
/// cubes of the levels 0 to max_level - 1.
struct OctreeRules {
  int max_level = 0;                          ///< <= kMaxOctreeLevel
  std::function<bool(std::uint64_t)> splits;  ///< whether a cube is too wide for a leaf
  std::function<bool(std::uint64_t)> wanted;  ///< whether the children of a cube are needed; if empty, all are
  std::size_t max_leaves = 0;
};

/// The leaves of the smallest balanced octree that splits all cubes required by the rules: leaves with a common corner,
/// edge or face differ by at most one level. The eight children of a cube are omitted together if `wanted` rejects it.
///
/// Balancing goes from the finest level to the coarsest, in one pass: the neighbours of a split cube must exist, so
/// their parents are split [Sundar2008].
/// @return cube_key()s, sorted: the leaves in Morton order
/// \throw std::length_error for more than max_leaves leaves
std::vector<std::uint64_t> balanced_octree(const OctreeRules& rules);

}  // namespace umtet
