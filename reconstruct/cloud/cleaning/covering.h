#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Representatives of a cloud: a subset of samples whose distance to the nearest is similar to the covering radius, the
/// distance from a point of the surface to the next sample. In an evenly sampled cloud every sample is a
/// representative.
struct Covering {
  std::vector<std::uint32_t> chosen;          ///< the representatives, ascending; empty: every point represents itself
  std::vector<std::uint32_t> representative;  ///< per point: index into `chosen`
  std::vector<int> n_represented;             ///< per representative: number of its points, itself included
  Neighbourhoods near;                        ///< neighbourhoods of the representatives, as indices into `chosen`

  bool is_even() const { return chosen.empty(); }
};

/// Finds the representatives of a cloud that may lie on scan lines.
///
/// The nearest neighbours of a sample on a scan line are all on its line, and their distances give no information about
/// the gap to the next line. Sample i is on a line if its k = 12 neighbours d_j = x_j - x_i have one direction, that is
///   (l_1 l_2 + l_1 l_3 + l_2 l_3) / (l_1 + l_2 + l_3)^2 < .05,   l the eigenvalues of sum_j d_j d_j^T
/// (a square lattice has .25, lines five times denser along than across have .2, six times 0), and if most of its
/// neighbours are on a line, too. Moments are about x_i and not about the mean, so that the edge of a hole is not a
/// line. Lines are thinned as in Poisson-disc sampling [Bridson2007], greedily in the order of points: a remaining
/// point represents the others on lines within half the distance of its 12th neighbour. Neighbours are then searched
/// among the representatives, until few are on lines.
///
/// Noise of a spacing and more hides a line from the twelve nearest neighbours; lines are therefore also searched among
/// every 4th and 16th point. A cloud is even if less than a hundredth of it is on lines. If there are some lines, .12
/// and a third of the neighbours suffice for more.
/// @param points  sorted in space, or in random order
/// @param near    the twelve nearest neighbours of all points
/// Cost: for even clouds a few per cent of the cost of their neighbours; otherwise a search for the neighbours of twice
/// as many points. Does not depend on the number of threads.
Covering covering(const std::vector<Vec3>& points, const Neighbourhoods& near);

/// Extracts points with all their data. @param points  ascending
OrientedPointCloud picked(const OrientedPointCloud& cloud, const std::vector<std::uint32_t>& points);

/// Neighbour distances for sample_areas() and sample_spacing(): `nearest` as for single points, and `mean_square` of
/// the representative, which divides its area among the points it represents.
/// @param near    neighbourhoods of all points
/// @param counts  counts of merged samples; empty: none was merged
NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, const Neighbourhoods& near,
                                       const Covering& covering, const std::vector<int>& counts = {});
/// The same with a search for neighbours. For a cloud with duplicates it is computed for the distinct positions, as if
/// these were sampled evenly.
/// \throw std::invalid_argument as neighbour_distances(points, kAreaNeighbours)
NeighbourDistances covered_distances(const std::vector<Vec3>& points, const std::vector<int>& counts = {});

}  // namespace umtet
