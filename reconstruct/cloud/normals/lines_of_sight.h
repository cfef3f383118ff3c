#pragma once

#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Tests whether the vectors given as normals are lines of sight. Some scanners store the direction to themselves
/// there. It varies smoothly from sample to sample and points outward, so only the positions reveal it. For up to 1,000
/// samples, evenly along the order of points, the angle between the vector and the normal of the quadric through the
/// neighbours is measured. Samples whose neighbours leave an uncertainty of more than 5 degrees are skipped.
///
/// The result is true if at least half of the samples were measured and half of these differ by more than 20 degrees.
/// For a ball seen from afar the median is 45 degrees, and a scan from all sides contains nothing else. Right normals
/// differ by the effects of noise and edges, 5 degrees at most over data/clouds; given normals with a noise of 20
/// degrees are worse than the normals from positions.
///
/// @param near      the nearest neighbours of all points
/// @param covering  covering of the points: on scan lines the neighbours of the representatives are used
/// \throw std::invalid_argument if the numbers of normals, rows of neighbours and points differ
/// Cost: a thousand quadric fits.
bool are_lines_of_sight(const OrientedPointCloud& cloud, const Neighbourhoods& near, const Covering& covering);

}  // namespace umtet
