#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Every normal looks to the nearest of the viewpoints. Returns how many were turned.
/// \throw std::invalid_argument  no viewpoints, one that is not finite, or not as many normals as points
std::size_t orient_from(OrientedPointCloud& cloud, const std::vector<Vec3>& viewpoints);

/// Every normal looks to the origin of its own sample; one whose origin is not finite stays. Returns how many were
/// turned. \throw std::invalid_argument  not as many origins as points, or as normals
std::size_t orient_to_origins(OrientedPointCloud& cloud);

}  // namespace umtet
