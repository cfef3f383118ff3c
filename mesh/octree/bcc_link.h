#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace umtet {

/// The neighbours of a vertex at which all tets are BCC tets of one size, ordered by z, then y, then x: the one below,
/// four corners of a cube, four neighbours in the plane, four corners, the one above.
using BccLink = std::array<std::int64_t, 14>;

/// Mean edge length of BCC tets in leaves of width 1: a vertex has six edges of 1 and eight of sqrt(3) / 2.
inline const double kBccMeanEdge = (6 + 8 * std::sqrt(.75)) / 14;

}  // namespace umtet
