#pragma once

#include <array>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "reconstruct/patches/patch_fit.h"
#include "reconstruct/patches/sample_patches.h"

namespace umtet {

/// A point where three or more patches meet, or where a curve ends between two.
struct TracedCorner {
  Vec3 place;
  std::vector<int> patches;  ///< ascending
  double off = 0;            ///< greatest distance of the place from the zero sets of the patches, model units
};

/// A curve f_a = f_b = 0 along the sharp border of two patches.
struct TracedCurve {
  std::array<int, 2> patches;          ///< a < b
  std::array<int, 2> ends = {-1, -1};  ///< corners at the first and the last point; -1 for a closed curve
  std::vector<Vec3> points;            ///< the first is repeated at the end of a closed curve
  std::vector<double> angle_deg;       ///< angle of the body at each point, in (0, 360)
  bool is_convex = true;               ///< the angle is less than 180 degrees
  bool is_closed() const { return ends[0] < 0; }
};

/// The curves and corners where the patches of a cloud meet.
struct TracedFeatures {
  std::vector<TracedCorner> corners;
  std::vector<TracedCurve> curves;
  std::vector<int> broken;  ///< corners of two patches: curves break off there
};

/// Traces the curves and corners of the fitted patches of a cloud.
///
/// Where samples of three patches are near each other, Newton's method on f_a = f_b = f_c = 0 gives a corner. Corners
/// within a spacing of each other are one; its place is the least-squares point of all its patches.
///
/// Pairs of neighbouring samples of two patches with a sharp border give seeds: Newton's method leads from their middle
/// to f_a = f_b = 0. From a seed the curve is followed in both directions, in steps that turn by no more than 15
/// degrees, while there are seeds, until it comes back or meets a corner. It is convex if the samples of each of
/// its patches are on the inner side of the other.
///
/// The result does not depend on the number of threads.
/// @param points  of the cloud
/// @param fits    of the patches of `patches`, by number
/// \throw Cancelled
TracedFeatures trace_patch_features(const std::vector<Vec3>& points, const SamplePatches& patches,
                                    const std::vector<PatchFit>& fits, const Context& context = {});

}  // namespace umtet
