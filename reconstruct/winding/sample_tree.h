#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A node of a binary tree over an array of samples: samples first .. last - 1. Its left child is the next node in the
/// array.
struct SampleTreeNode {
  std::uint32_t first = 0, last = 0;
  std::uint32_t right = 0;  ///< index of the right child; 0: a leaf
};

/// Maximum depth. A node has half the samples of its parent, so a traversal keeps at most this many pending right
/// children.
inline constexpr std::size_t kDeepestSampleTree = 40;

/// Builds a tree. Sorts samples first .. last - 1 so that each node has half the samples of its parent, split along the
/// longest axis of the parent's box, and appends the nodes, parents before children.
/// @param samples  each with a position x and a unique number
/// @param nodes    derived from SampleTreeNode
/// @param leaf     maximum size of a leaf; a sum over a cluster costs about as much as `leaf` samples
/// @return index of the first appended node. Cost: O(n log n)
template <class Sample, class Node>
std::uint32_t grow_sample_tree(std::vector<Sample>& samples, std::vector<Node>& nodes, std::uint32_t leaf,
                               std::uint32_t first, std::uint32_t last) {
  const auto number = static_cast<std::uint32_t>(nodes.size());
  Node& node = nodes.emplace_back();
  node.first = first;
  node.last = last;
  if (last - first <= leaf) return number;
  Vec3 least = samples[first].x, most = least;
  for (std::uint32_t i = first; i < last; ++i) {
    least = least.cwiseMin(samples[i].x);
    most = most.cwiseMax(samples[i].x);
  }
  Eigen::Index axis = 0;
  (most - least).maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  const auto at = [&](std::uint32_t i) { return samples.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last), [axis](const Sample& a, const Sample& b) {
    return a.x[axis] < b.x[axis] || (a.x[axis] == b.x[axis] && a.number < b.number);
  });
  grow_sample_tree(samples, nodes, leaf, first, middle);
  const std::uint32_t right = grow_sample_tree(samples, nodes, leaf, middle, last);
  nodes[number].right = right;
  return number;
}

}  // namespace umtet
