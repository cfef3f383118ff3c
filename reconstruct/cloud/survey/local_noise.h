#pragma once

#include <vector>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Local noise: detects where samples contradict those beside them. Scans that overlap with an offset form two sheets
/// with the same normals, and the surface is somewhere between.
///
/// Computes the standard deviation of each sample's neighbourhood along the normals. Over its twelve nearest samples
/// with n_i . n_j > .9, sigma_i^2 = 1/2 mean of (1/2 (n_i + n_j) . (x_j - x_i))^2. This vanishes to third order on a
/// smooth surface. For two close sheets sigma_i is half their offset, and less if they are more than a spacing apart.
/// The result is the median over the neighbours. Edges and opposite sides have other normals.
///
/// @param cloud  the cloud of the tree; with normals, unit or zero
/// @param usual  noise of the samples elsewhere
/// @return empty if less than a hundredth of 5000 samples, evenly picked, exceed both twice the usual noise and a fifth
///         of the distance to the twelfth neighbour
/// Cost: if it is empty, a search of twelve neighbours for the 5000 samples, else for all. The result does not depend
/// on the number of threads.
std::vector<double> local_noise(const OrientedPointCloud& cloud, const NeighbourTree& tree, double usual);

}  // namespace umtet
