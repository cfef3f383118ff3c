#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

// Sixth powers of lengths, products of volumes, must stay normal doubles; no unit makes a body so large or so small.
inline constexpr double kFarthest = 1e50;

/// A body needs samples in three dimensions, and more than a handful of places.
/// \throw CloudRefused  fewer than `fewest` different places, all on a line or a plane, or within 1e-50
void check_extent(const CloudSource& source, const std::vector<Vec3>& points, std::size_t fewest);

}  // namespace umtet::detail
