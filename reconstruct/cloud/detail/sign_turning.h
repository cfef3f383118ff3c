#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "reconstruct/cloud/sign_graph.h"

namespace umtet {

/// Step 3 of solve_signs: from signs that satisfy most pairs to signs that no turn of these kinds makes better.

/// Pairs by point.
struct SignAdjacency {
  std::vector<std::uint32_t> first;
  std::vector<std::pair<std::uint32_t, float>> entries;
  SignAdjacency(std::size_t n_points, const std::vector<SignEdge>& edges);
};

/// Whether a pair says, by more than rounding, that one of its two is turned over.
bool has_disagreement(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>& sign);

/// Turns a group of points (a patch, or a single point) over when its pairs to the rest disagree in sum, until there
/// is none.
void turn_groups(const SignAdjacency& adjacency, const std::vector<std::uint32_t>& group, std::uint32_t n_groups,
                 std::vector<std::int8_t>& sign);

/// A thin fin with wrong signs consists of many patches, and to turn only one of them is no gain. From every patch
/// whose border to another is clearly in disagreement a region grows by the patch that brings the sum over its border
/// down most, up to 64 patches, and what had the least sum is turned over if that is below zero. Cost: bounded for each
/// patch in disagreement.
void turn_regions(const std::vector<SignEdge>& edges, const std::vector<std::uint32_t>& patch, std::uint32_t n_patches,
                  std::vector<std::int8_t>& sign);

}  // namespace umtet
