#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

// Maximum coordinate: sixth powers of lengths, as products of volumes, must be normal doubles. No unit makes a body so
// large or so small.
inline constexpr double kFarthest = 1e50;

/// Checks that points extend in three dimensions and have sufficiently many positions.
/// \throw CloudRefused for fewer than `fewest` different positions, or positions on a line or a plane, or within 1e-50
void check_extent(const CloudSource& source, const std::vector<Vec3>& points, std::size_t fewest);

}  // namespace umtet::detail
