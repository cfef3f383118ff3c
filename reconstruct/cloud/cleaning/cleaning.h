#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Parameters of clean().
struct CleaningParams {
  bool outliers = true;  ///< false: drops only points that are not finite and duplicates
  double suspicious_crowd =
      3;  ///< times the number of points that its spacing predicts around it: an outlier if off their plane; > 1
  double certain_crowd = 20;  ///< times that number: an outlier anywhere; >= suspicious_crowd
  std::size_t small_component_points =
      100;  ///< a small component has fewer points than this, and less than a hundredth of the cloud,
  double small_component_distance = 10;  ///< and its distance from the rest is this many of its own spacings; > 1
};
std::vector<std::string> problems(const CleaningParams&);

/// Report of clean(): the points kept and dropped.
struct CleaningReport {
  std::vector<std::uint32_t> kept;     ///< indices of the remaining points in the original cloud, ascending
  std::size_t n_not_finite = 0;        ///< points with coordinates that are NaN, infinite or beyond 1e50
  std::size_t n_duplicates = 0;        ///< points at the position of an earlier one
  std::size_t n_outliers = 0;          ///< points far from a surface, relative to the spacing of its points
  std::size_t n_small_components = 0;  ///< points of small components far from the rest
  std::size_t n_small_component_pieces = 0;
  std::vector<Vec3> outliers, small_components;  ///< positions of these points
};

/// Cleaning of a scan: drops points that are not samples of a surface. Normals may be missing (an empty array).
///
/// - Duplicates: of the points at one position the first is kept with its normal. An average would change bits, and
///   would cancel where both sides of a sheet meet.
/// - Outliers are sparse points beside dense ones. Let d be the distance of the 12th neighbour. On a surface, the ball
///   of radius 3 d contains 9 * 12 points at any density. It contains three times as many beside a region that is
///   scanned five times as densely, or if the point is four spacings away from a surface; the plane of the neighbours
///   distinguishes these cases. Twenty times as many occur on no surface.
///
/// The criterion is local. PCL's StatisticalOutlierRemoval instead takes one threshold from all distances: it drops the
/// sparse part of clouds with varying density, and a single far point hides all others. Here the distance of outliers
/// does not matter, nor whether they are neighbours of each other.
///
/// On scan lines, representatives (covering.h) are tested, and the points that they represent are dropped with them:
/// relative to the spacing on a line, the next line is far away.
///
/// @param neighbours   if given: receives the twelve nearest neighbours of the remaining points (empty for fewer than
///                     two points)
/// @param covers_left  if given: receives the covering of the remaining points
/// \throw std::invalid_argument for an array whose length differs from the number of points, or a problem of the
///        parameters
/// Cost: O(n log n), a few microseconds per point. The result does not depend on the number of threads.
CleaningReport clean(OrientedPointCloud& cloud, const CleaningParams& params = {}, Neighbourhoods* neighbours = nullptr,
                     Covering* covers_left = nullptr);

}  // namespace umtet
