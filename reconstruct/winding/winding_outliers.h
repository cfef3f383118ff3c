#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Detects samples that lie on no surface, with a flag for each. A sample is an outlier if it is
/// - inside or outside of the volume that all samples enclose: |w - 1/2| > .4 for its winding number, and
/// - isolated: the distance of its fourth neighbour is 2.5 times the same distance at its neighbours (or four times the
///   usual distance in the cloud, if all samples around are also outliers).
///
/// Cleaning detects sparse points beside dense ones, from points alone; this function is for samples that fill a
/// volume, and for samples near the surface. At the tip of a spike w is also small, but its samples are as close to
/// each other as elsewhere. For merged samples, distances before merging are used.
/// @param cloud  sorted in space (morton_order.h); unit or zero normals
/// @param near   neighbourhoods of its points
/// Cost: a pass over the neighbours, and, if samples are isolated, a winding number of at most 30,000 samples, which
/// takes a tenth of a second. The result does not depend on the number of threads.
std::vector<std::uint8_t> winding_outliers(const OrientedPointCloud& cloud, const Neighbourhoods& near);

}  // namespace umtet
