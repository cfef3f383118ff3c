#pragma once

#include <vector>

#include "reconstruct/cloud/neighbour_tree.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Where samples contradict those beside them: scans that overlap with an offset are two sheets, with the same normals,
/// and the surface is somewhere between.
///
/// Standard deviation of each sample's neighbourhood along the normals: over its twelve nearest with n_i . n_j > .9,
/// sigma_i^2 = 1/2 mean of (1/2 (n_i + n_j) . (x_j - x_i))^2, which vanishes to third order on a smooth surface and is
/// half the offset of two sheets that are near, less where they are more than a spacing apart; then the median over
/// them. Edges and opposite sides have other normals.
///
/// @param cloud  of the tree; with normals, unit or zero
/// @param usual  noise of the samples elsewhere
/// @return empty where less than a hundredth of 5000 samples, evenly picked, have over twice the usual and a fifth of
///         the distance to the twelfth
/// Cost: where it is empty, a search of twelve neighbours for the 5000; else for all. The result does not depend on the
/// number of threads.
std::vector<double> local_noise(const OrientedPointCloud& cloud, const NeighbourTree& tree, double usual);

}  // namespace umtet
