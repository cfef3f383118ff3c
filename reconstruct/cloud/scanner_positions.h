#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Every normal looks to the nearest of the viewpoints. Returns how many were turned.
/// \throw std::invalid_argument  no viewpoints, one that is not finite, or not as many normals as points
std::size_t orient_from(OrientedPointCloud& cloud, const std::vector<Vec3>& viewpoints);

/// Normals look to the origins of their own samples: all are turned where most look away, and of what is left those
/// that look away by more than 30 degrees beyond the horizon; estimated normals seen at a grazing angle are no proof. A
/// sample whose origin is not finite goes with the most. Returns how many were turned. \throw std::invalid_argument not
/// as many origins as points, or as normals
std::size_t orient_to_origins(OrientedPointCloud& cloud);

/// Share of normals that look away from their origins. \throw as orient_to_origins
double share_looking_away(const OrientedPointCloud& cloud);

}  // namespace umtet
