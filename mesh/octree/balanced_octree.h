#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace umtet {

/// What an octree is made from. Both are called by several threads at once, level by level, with the cube_key() of
/// cubes of the levels 0 to max_level - 1.
struct OctreeRules {
  int max_level = 0;                          ///< <= kMaxOctreeLevel
  std::function<bool(std::uint64_t)> splits;  ///< whether a cube is too wide to be a leaf
  std::function<bool(std::uint64_t)> wanted;  ///< whether the children of a cube are of use; empty: all are
  std::size_t max_leaves = 0;
};

/// The leaves of the least octree that splits where it is asked to and is balanced: leaves that share a corner, an edge
/// or a face differ by one level at most. Children are left out, eight together, where their parent is not wanted.
///
/// Balance goes from the finest level to the coarsest, once: the neighbours of a split cube must exist, so their
/// parents are split [Sundar2008].
/// @return cube_key()s, sorted: the leaves in Morton order
/// \throw std::length_error for more than max_leaves
std::vector<std::uint64_t> balanced_octree(const OctreeRules& rules);

}  // namespace umtet
