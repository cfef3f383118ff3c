#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Distances from every point to its neighbours, over the distinct places of the cloud: points with equal coordinates
/// are one place and get the same numbers, so a duplicate is nobody's neighbour and no distance is zero.
struct NeighbourDistances {
  std::vector<double> nearest;      ///< d_1: to the nearest other place, model units
  std::vector<double> mean_square;  ///< (d_1^2 + ... + d_k^2) / k, model units squared
  int k = 0;  ///< neighbours in mean_square: the k of the call, or places - 1 where there are not as many
  std::vector<int> multiplicity;  ///< how many points of the cloud share the place of this one, or the area of its
                                  ///< representative (covering.h); >= 1
  std::vector<std::uint32_t> representatives = {};  ///< those of a cloud on scan lines, ascending; empty: all points
  std::vector<double> weights = {};  ///< of merged samples, what each counts for its area (relative_counts()); empty: 1
};

/// Exact nearest neighbours by a k-d tree, in double. The result does not depend on the number of threads.
///
/// \throw std::invalid_argument  k < 1, a coordinate not finite, or fewer than two distinct places
/// Cost: O(n log n + n k) (reconstruct_bench --benchmark_filter=SampleAreas).
NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, int k);
/// The same from neighbours that are known: of a cloud without duplicates, with k = near.k().
NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, const Neighbourhoods& near);

/// Median over the points of the distance to the nearest other place (model units).
/// \throw std::invalid_argument  as neighbour_distances
double median_spacing(const std::vector<Vec3>& points);
double median_spacing(const NeighbourDistances& near);

inline constexpr int kAreaNeighbours = 12;  ///< Neighbourhoods::kDefault: two rings of samples

/// a_i: the area of surface that sample i stands for (model units squared).
///
/// Around sample i, pi d_j^2 / a is j on average for white noise, j + 1/2 for a lattice and j + 0.9 for Poisson discs.
/// a_i takes j + 1/2 for all, so that pi (d_1^2 + ... + d_k^2) = a_i k (k + 2) / 2; with k = 12 the sum over a
/// uniformly sampled surface is 7 % below its area for white noise and 5 % above it for Poisson discs. Summing over the
/// rings, instead of taking d_k alone, averages over the steps in which the d_j of regular samplings rise. Points at
/// one place share its area.
///
/// @note At the edge of a hole half the disc is empty and a_i is up to twice too large. On sheets thinner than
///       d_k the other side is counted and a_i is up to twice too small.
/// \throw std::invalid_argument  as neighbour_distances
std::vector<double> sample_areas(const std::vector<Vec3>& points, int k = kAreaNeighbours);
std::vector<double> sample_areas(const NeighbourDistances& near);

/// The distance between samples: root of the median over places of the area around them (model units). On scan lines
/// that of the representatives over 1.5, about two fifths of the gap: between gaps, samples show more along lines.
double sample_spacing(const NeighbourDistances& near);

/// What to subtract from clouds far from the origin (geo-referenced scans), where squares and differences of
/// coordinates lose digits: zero unless max |coordinate| > 1e3 * diagonal of the box; then, on the axes where the box
/// is away from 0, its centre rounded to a power of two near the diagonal. So rounded, x - shift is exact
/// and (x - shift) + shift gives x back bit by bit.
Vec3 far_origin_shift(const OrientedPointCloud& cloud);

}  // namespace umtet
