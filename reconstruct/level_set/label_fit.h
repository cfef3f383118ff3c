#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/level_set/mask_fit.h"

namespace umtet {

/// psi of one label among others: negative where the label is. Each point of space belongs to the label with the least
/// function. Beyond four voxels from its surface, psi has the constant value of this distance, so that most points cost
/// a look at one voxel. Thread-safe.
class LabelLevelSet {
 public:
  /// @param is_outside  psi is that of all voxels that are not in the mask, the space around the image included
  LabelLevelSet(MaskFit fit, bool is_outside);

  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  const MaskReport& report() const { return report_; }
  /// The voxels of the mask, which are those of other labels if this is the outside.
  const BodyVoxels& voxels() const { return voxels_; }

 private:
  enum class Place : std::uint8_t { Inside, Near, Outside };

  GridLevelSet psi_;
  MaskReport report_;
  BodyVoxels voxels_;
  Mat3 to_nodes_;
  double far_;  ///< model units
  double sign_;
  std::vector<Place> place_;  ///< per voxel of the mask
};

/// Fits one level set to each label of a segmentation by fit_mask(), and first one to label 0, all around them.
///
/// At voxel centres the least function is that of the voxel's label but for the centres that fit_mask() changes, since
/// each has the sign of its own mask there. Two labels that touch share the surface psi_a = psi_b; neither of the two
/// surfaces psi_a = 0 and psi_b = 0 alone is the boundary, and no gap opens between them.
/// @param labels  the numbers of label_parts() to fit, without 0
/// @return one function for label 0 and one for each of `labels`, in this order
/// \pre problems(grid) is empty
/// \throw std::invalid_argument if a label has no voxel
std::vector<LabelLevelSet> fit_labels(const Grid& grid, const std::vector<double>& labels);

}  // namespace umtet
