#pragma once

#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Groups points: points in the same cube of edge `size`, or in cubes that touch, belong to the same set.
/// @return for each point the least index in its set
/// Cost: O(n log n).
std::vector<int> clusters(const std::vector<Vec3>& x, double size);

/// Returns the members of each set in ascending order. The sets are in the order of their least members.
std::vector<std::vector<int>> members_of(const std::vector<int>& set);

}  // namespace umtet
