#pragma once

#include <vector>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"

namespace umtet {

/// Normals without noise that keep sharp edges.
struct FilteredNormals {
  std::vector<Vec3> normals;  ///< [n] unit, outward
  double tilt = 0;            ///< standard deviation of the given normals about each tangent, radians
};

/// Filters measured normals: a joint bilateral filter. Its guide at a sample is the mean normal of the most consistent
/// neighbourhood that contains the sample, which lies on one side of an edge; but only if it agrees with the sample's
/// own normal. Then the filter repeats with the result as guide.
/// @param points   in sample spacings
/// @param normals  unit, outward
/// @param near     at least 16 neighbours of each point, nearest first
/// Cost: O(n). The result does not depend on the number of threads.
FilteredNormals filter_normals(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                               const Neighbourhoods& near);

/// Estimates normals anew, by the plane of the most consistent neighbourhood that contains a sample and the quadric
/// through it. Given normals determine the sides only. The tilt of the result is infinite: these normals tell nothing
/// that positions do not.
FilteredNormals estimate_edged_normals(const std::vector<Vec3>& points, const std::vector<Vec3>& sides,
                                       const Neighbourhoods& near);

}  // namespace umtet
