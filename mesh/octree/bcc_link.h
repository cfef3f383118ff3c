#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace umtet {

/// The neighbours of a vertex all of whose tets are BCC tets of one size, by z, then y, then x of their places: below,
/// four corners of a cube, four neighbours in the plane, four corners, above.
using BccLink = std::array<std::int64_t, 14>;

/// Mean edge length of BCC tets in leaves of width 1: six edges of 1 and eight of sqrt(3) / 2 meet at a vertex.
inline const double kBccMeanEdge = (6 + 8 * std::sqrt(.75)) / 14;

}  // namespace umtet
