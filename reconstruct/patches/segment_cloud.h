#pragma once

#include <string>
#include <vector>

#include "reconstruct/patches/sample_patches.h"

namespace umtet {

/// Parameters of segment_cloud().
struct SegmentationParams {
  double least_angle = 30;  ///< degrees between the normals of two patches: below it a border is not sharp; in [30, 90]
  bool measured_normals = true;  ///< false: normals are estimated from positions, and only their sides are used
};
std::vector<std::string> problems(const SegmentationParams&);

/// Fewest samples of a cloud that is divided. Smaller clouds are one patch.
inline constexpr std::size_t kFewestSegmented = 100;

/// Divides a cloud into smooth patches that meet at sharp edges.
///
/// 1. Normals are filtered such that edges stay (filtered_normals.h).
/// 2. Regions of smooth normals grow (patch_growing.h).
/// 3. Samples near borders move to the patch whose local quadric fits them best (patch_reassignment.h). Patches that
///    continue each other merge (patch_merging.h). Both are done twice.
/// 4. A border is an edge if two quadrics explain the samples beside it, and one does not (edge_evidence.h). Others are
///    merged away (edge_acceptance.h).
///
/// More is asked where patches are not quadrics up to noise, as on organic shapes. If normals are estimated, such a
/// cloud is one patch, and so is one with a noise of more than .3 spacings.
///
/// Given normals that are averages over neighbours hide edges. If they show none, but patches are quadrics up to a
/// noise of .06 spacings, the same is tried with normals from positions.
///
/// @param points   finite
/// @param normals  outward; unit, or zero where unknown
/// @param spacing  sample spacing (sample_spacing()), model units; > 0
/// \throw std::invalid_argument if the numbers of points and normals differ, or for a problem of the other arguments
/// Cost: O(n log n), about a second per 100,000 samples on one core. Scaling the cloud scales the result. It does not
/// depend on the number of threads.
SamplePatches segment_cloud(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, double spacing,
                            const SegmentationParams& params = {});

}  // namespace umtet
