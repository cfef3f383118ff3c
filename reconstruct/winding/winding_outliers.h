#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Samples that lie on no surface, one flag each: inside or outside of what all samples enclose, |w - 1/2| > .4 of
/// their winding number, and apart: their fourth neighbour is 2.5 times as far away as that of their neighbours (or
/// four times what is usual in the cloud, where all around are outliers, too). Cleaning finds what is sparse beside
/// something dense, from points alone; this is for what fills a volume, and for what is near the surface. At the tip of
/// a spike w is small, too, but its samples are as near to each other as elsewhere. Of merged samples distances are
/// taken as they were before.
/// @param cloud  sorted in space (morton_order.h); unit or zero normals
/// @param near   of its points
/// Cost: a pass over the neighbours; where samples are apart, a winding number of at most 30,000 samples, a tenth of a
/// second. The result does not depend on the number of threads.
std::vector<std::uint8_t> winding_outliers(const OrientedPointCloud& cloud, const Neighbourhoods& near);

}  // namespace umtet
