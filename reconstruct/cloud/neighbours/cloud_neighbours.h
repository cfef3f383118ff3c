#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Distances from every point to its neighbours, over the distinct positions of the cloud. Points with equal
/// coordinates are one position and get the same numbers, so a duplicate is not a neighbour and no distance is zero.
struct NeighbourDistances {
  std::vector<double> nearest;      ///< d_1: to the nearest other position, model units
  std::vector<double> mean_square;  ///< (d_1^2 + ... + d_k^2) / k, model units squared
  int k = 0;                      ///< neighbours in mean_square: the k of the call, or positions - 1 if there are fewer
  std::vector<int> multiplicity;  ///< points at this position, or the area of its representative (covering.h); >= 1
  std::vector<std::uint32_t> representatives = {};  ///< representatives on scan lines, ascending; empty: all points
  std::vector<double> weights = {};                 ///< weights of merged samples' areas (relative_counts()); empty: 1
};

/// Exact distances to the k nearest neighbours by a k-d tree, in double. The result does not depend on the number of
/// threads.
///
/// \throw std::invalid_argument for k < 1, a coordinate that is not finite, or fewer than two distinct positions
/// Cost: O(n log n + n k) (reconstruct_bench --benchmark_filter=SampleAreas).
NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, int k);
/// The same from known neighbours, for a cloud without duplicates, with k = near.k().
NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, const Neighbourhoods& near);

/// Median over the points of the distance to the nearest other position (model units).
/// \throw std::invalid_argument as neighbour_distances()
double median_spacing(const std::vector<Vec3>& points);
double median_spacing(const NeighbourDistances& near);

inline constexpr int kAreaNeighbours = 12;  ///< Neighbourhoods::kDefault: two rings of samples

/// Sample areas: a_i is the area of surface that sample i represents (model units squared).
///
/// Around sample i, pi d_j^2 / a is on average j for white noise, j + 1/2 for a lattice and j + 0.9 for Poisson discs.
/// a_i assumes j + 1/2 for all, so that pi (d_1^2 + ... + d_k^2) = a_i k (k + 2) / 2. With k = 12 the sum over a
/// uniformly sampled surface is 7 % below its area for white noise and 5 % above it for Poisson discs. The sum over the
/// rings, instead of d_k alone, averages over the steps in which the d_j of regular samplings rise. Points at one
/// position share its area.
///
/// @note At the edge of a hole, half the disc is empty and a_i is up to twice too large. On sheets thinner than d_k,
///       the other side is counted and a_i is up to twice too small.
/// \throw std::invalid_argument as neighbour_distances()
std::vector<double> sample_areas(const std::vector<Vec3>& points, int k = kAreaNeighbours);
std::vector<double> sample_areas(const NeighbourDistances& near);

/// Sample spacing: the root of the median area over positions (model units). On scan lines it is the spacing of the
/// representatives divided by 1.5, about two fifths of the gap: between gaps, samples resolve more along lines.
double sample_spacing(const NeighbourDistances& near);

/// Shift of a cloud far from the origin (a geo-referenced scan), where squares and differences of coordinates lose
/// digits. It is zero unless max |coordinate| > 1e3 * diagonal of the box. Otherwise, on the axes where the box is away
/// from 0, it is the box's centre rounded to a power of two near the diagonal. With this rounding x - shift is exact,
/// and (x - shift) + shift gives x bit by bit.
Vec3 far_origin_shift(const OrientedPointCloud& cloud);

}  // namespace umtet
