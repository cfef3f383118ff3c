#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// The lowest 21 bits of v, two zeros between each of them: of three of them a Morton code is made.
std::uint64_t spread_bits(std::uint64_t v);

/// The points along Morton's curve through their bounding box, those of one of its 2^63 cells by their coordinates, and
/// those at one place as they come: successive points are near each other, and every m-th of them are spread
/// evenly. Any coordinates, finite or not. Does not depend on the number of threads.
std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& points);

/// Puts a cloud in that order. What is made from it then does not depend on the order in which the points came, and
/// neighbours in space are neighbours in memory, which makes everything after it faster.
/// All but the points may be missing.
void sort_in_space(OrientedPointCloud& cloud);

}  // namespace umtet
