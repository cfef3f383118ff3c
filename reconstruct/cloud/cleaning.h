#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/cloud/covering.h"
#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

struct CleaningParams {
  bool outliers = true;  ///< false: only what is no number and what is there twice goes (--keep-all)
  double suspicious_crowd =
      3;  ///< this many times the points that its spacing predicts around it: an outlier if off their plane; > 1
  double certain_crowd = 20;  ///< this many times: an outlier wherever it is; >= suspicious_crowd
  std::size_t small_component_points =
      100;  ///< a small component has fewer points than this, and less than a hundredth of the cloud,
  double small_component_distance = 10;  ///< and is this many of its own spacings from the rest; > 1
};
std::vector<std::string> problems(const CleaningParams&);

struct CleaningReport {
  std::vector<std::uint32_t> kept;     ///< which points of the cloud that came are left, ascending
  std::size_t n_not_finite = 0;        ///< coordinates NaN, infinite or beyond 1e50
  std::size_t n_duplicates = 0;        ///< at the place of an earlier point
  std::size_t n_outliers = 0;          ///< far from a surface for how near its points are to each other
  std::size_t n_small_components = 0;  ///< points of small pieces far from the rest
  std::size_t n_small_component_pieces = 0;
};

/// Drops what is no sample of a surface. Normals may be missing (an empty array).
///
/// Of points at one place the first is kept with its normal: an average would change bits, and cancel where both sides
/// of a sheet meet.
///
/// An outlier is sparse beside something dense. Let d be the distance of the 12th neighbour: on a surface the ball of
/// radius 3 d holds 9 * 12 points whatever the density; three times that beside a region scanned five times as densely,
/// or when the point is four spacings away from a surface; the plane of its neighbours tells these apart. Twenty times
/// is no surface at all. That judges by the place and not by the cloud, as PCL's StatisticalOutlierRemoval does, which
/// takes one threshold from all distances: it drops the sparse part of clouds whose density varies, and one point far
/// away hides all others. It does not matter how far away outliers are, nor that they are neighbours of each other.
///
/// On scan lines representatives (covering.h) are judged, and what they stand for goes with them: a line is far from
/// the next one for how near its points are to each other.
///
/// @param neighbours  if given: becomes the twelve nearest of what is left (empty for fewer than two points)
/// @param covers_left  if given: becomes the covering of that
/// \throw std::invalid_argument  an array that has not as many entries as there are points; a problem of the parameters
/// Cost: O(n log n), a few microseconds a point. The result does not depend on the number of threads.
CleaningReport clean(OrientedPointCloud& cloud, const CleaningParams& params = {}, Neighbourhoods* neighbours = nullptr,
                     Covering* covers_left = nullptr);

}  // namespace umtet
