#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "reconstruct/cloud/normals/sign_graph.h"

namespace umtet {

/// Local search of solve_signs(), step 3: improves signs until no turn of these kinds increases the agreement.

/// Adjacency lists: pairs by point.
struct SignAdjacency {
  std::vector<std::uint32_t> first;
  std::vector<std::pair<std::uint32_t, float>> entries;
  SignAdjacency(std::size_t n_points, const std::vector<SignEdge>& edges);
};

/// True if a pair indicates, by more than rounding, that one of its points is turned over.
bool has_disagreement(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>& sign);

/// Turns over groups of points (patches, or single points) whose pairs to the rest disagree in sum, until there are
/// none.
void turn_groups(const SignAdjacency& adjacency, const std::vector<std::uint32_t>& group, std::uint32_t n_groups,
                 std::vector<std::int8_t>& sign);

/// Turns over regions of several patches. A thin fin with wrong signs consists of many patches, and turning a single
/// one is no gain. From every patch whose border to another clearly disagrees, a region grows by the patch that reduces
/// the sum over its border most, up to 64 patches. The region with the least sum is turned over if this is below zero.
/// Cost: bounded for each disagreeing patch.
void turn_regions(const std::vector<SignEdge>& edges, const std::vector<std::uint32_t>& patch, std::uint32_t n_patches,
                  std::vector<std::int8_t>& sign);

}  // namespace umtet
