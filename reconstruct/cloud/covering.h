#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Samples that stand for the others: among them the distance to the nearest is like the covering radius, how far a
/// point of the surface may be from the next sample. In a cloud that is sampled evenly every sample is one.
struct Covering {
  std::vector<std::uint32_t> chosen;          ///< the representatives, ascending; empty: every point is its own
  std::vector<std::uint32_t> representative;  ///< of every point: a row of `chosen`
  std::vector<int> n_represented;             ///< points, itself among them; a row of `chosen` each
  Neighbourhoods near;                        ///< of the representatives, in rows of `chosen`

  bool is_even() const { return chosen.empty(); }
};

/// The nearest samples of one on a scan line lie all on its line, and their distances say nothing about the gap to the
/// next one. Sample i is on a line where its k = 12 neighbours d_j = x_j - x_i have one direction, that is
///   (l_1 l_2 + l_1 l_3 + l_2 l_3) / (l_1 + l_2 + l_3)^2 < .05,   l the eigenvalues of sum_j d_j d_j^T
/// (a square lattice has .25, lines five times denser along than across .2, six times 0), and most of them are, too.
/// Moments about x_i and not about the mean: the edge of a hole is no line. Lines are thinned as for a Poisson-disc
/// sampling [Bridson2007], greedily in the order of points: who is left stands for the others on lines within half the
/// distance of its 12th neighbour. Then neighbours are searched among the representatives, until few lie on lines.
///
/// Noise of a spacing and more hides a line from the twelve nearest; they are looked for among every 4th and 16th
/// point, too. A cloud is even if less than a hundredth of it is on lines; where there are some, .12 and a third
/// of the neighbours are enough for more.
/// @param points  sorted in space, or at random
/// @param near    the twelve nearest of all
/// Cost: of even clouds a few per cent of what their neighbours cost; else of a search for twice as many points. Does
/// not depend on the number of threads.
Covering covering(const std::vector<Vec3>& points, const Neighbourhoods& near);

/// These points with all that is known of them. @param points  ascending
OrientedPointCloud picked(const OrientedPointCloud& cloud, const std::vector<std::uint32_t>& points);

/// Neighbours for sample_areas and sample_spacing: `nearest` as it is, `mean_square` that of the representative, which
/// shares its area among the points that it stands for.
/// @param near  of all points
/// @param counts  of samples that were merged; empty: none was
NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, const Neighbourhoods& near,
                                       const Covering& covering, const std::vector<int>& counts = {});
/// The same, searched: of a cloud with duplicates that of its places, as if these were sampled evenly.
/// \throw std::invalid_argument  as neighbour_distances(points, kAreaNeighbours)
NeighbourDistances covered_distances(const std::vector<Vec3>& points, const std::vector<int>& counts = {});

}  // namespace umtet
