#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Orients every normal towards the nearest viewpoint. Returns the number of normals turned.
/// \throw std::invalid_argument for no viewpoints, a viewpoint that is not finite, or if the numbers of normals and
///        points differ
std::size_t orient_from(OrientedPointCloud& cloud, const std::vector<Vec3>& viewpoints);

/// Orients normals towards the origins of their own samples. All normals are turned if most point away. Of the others,
/// those are then turned that point away by more than 30 degrees beyond the horizon, because estimated normals at a
/// grazing angle are not reliable. A sample whose origin is not finite follows the majority. Returns the number of
/// normals turned.
/// \throw std::invalid_argument if the numbers of origins, normals and points differ
std::size_t orient_to_origins(OrientedPointCloud& cloud);

/// Fraction of normals that point away from their origins. \throw as orient_to_origins()
double share_looking_away(const OrientedPointCloud& cloud);

}  // namespace umtet
