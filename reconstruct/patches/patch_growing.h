#pragma once

#include <vector>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"

namespace umtet {

/// Divides samples into regions in which filtered normals vary smoothly. Samples that agree with all neighbours are the
/// cores of regions. Every other sample joins the region whose normals are nearest to its own.
/// @param points   in sample spacings
/// @param normals  unit, filtered
/// @return the region of every sample, numbered from 0 in the order of their first samples
/// Cost: O(n log n)
std::vector<int> grow_patches(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                              const Neighbourhoods& near);

/// Numbers labels from 0 in the order of their first samples. @return the number of labels
int renumber(std::vector<int>& labels);

}  // namespace umtet
