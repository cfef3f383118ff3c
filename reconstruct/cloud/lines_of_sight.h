#pragma once

#include "reconstruct/cloud/covering.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Whether the vectors that a cloud has as normals are none. Some scanners store the direction to themselves there: it
/// is smooth from sample to sample and looks outward, so only the positions tell. Of up to 1,000 samples, evenly along
/// the order of points, the angle between the vector and the normal of the quadric through the neighbours is taken;
/// samples whose neighbours leave more than 5 degrees of doubt are not asked.
///
/// True where at least half were asked and half of these are more than 20 degrees off. A scanner sees a ball from afar
/// with a median of 45 degrees, and from all sides nothing else. Right normals leave what noise and edges do, 5 degrees
/// at most over data/clouds; given normals with a noise of 20 are worse than those of the positions.
///
/// @param near      the nearest of all points
/// @param covering  of the points: on scan lines the neighbours are those of the representatives
/// \throw std::invalid_argument  not as many normals, or rows of neighbours, as points
/// Cost: of a thousand quadrics.
bool are_lines_of_sight(const OrientedPointCloud& cloud, const Neighbourhoods& near, const Covering& covering);

}  // namespace umtet
