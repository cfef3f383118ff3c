#pragma once

#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Sets of points: those in one cube of edge `size`, or in cubes that touch, are together.
/// @return one number a point, the least index in its set
/// Cost: O(n log n).
std::vector<int> clusters(const std::vector<Vec3>& x, double size);

/// The members of each set, ascending; the sets by their least members.
std::vector<std::vector<int>> members_of(const std::vector<int>& set);

}  // namespace umtet
