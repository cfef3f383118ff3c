#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Spreads the lowest 21 bits of v, with two zeros between each: three such numbers form a Morton code.
std::uint64_t spread_bits(std::uint64_t v);

/// Order of the points along Morton's curve through their bounding box. Points in one of its 2^63 cells are ordered by
/// their coordinates, and points at one position keep their order. Successive points are close to each other, and every
/// m-th of them are spread evenly. Coordinates may be arbitrary, finite or not. Does not depend on the number of
/// threads.
std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& points);

/// Sorts a cloud into Morton order. Results made from it then do not depend on the original order of the points, and
/// neighbours in space are neighbours in memory, which makes all later steps faster. All arrays but the points may be
/// missing.
void sort_in_space(OrientedPointCloud& cloud);

}  // namespace umtet
