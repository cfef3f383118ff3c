#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/level_set/grid.h"

namespace umtet {

/// A part of a segmentation: the voxels with one number.
struct LabelPart {
  double number = 0;
  std::size_t n_voxels = 0;
  Eigen::Vector3i first = Eigen::Vector3i::Zero(), last = Eigen::Vector3i::Zero();  ///< bounding box, in voxels
  bool at_wall = false;  ///< true if it has a voxel in an outermost layer of the image
};

/// All parts but 0, ascending by number.
std::vector<LabelPart> label_parts(const Grid& grid);

/// Connected components and thickness of a part.
struct PartShape {
  std::size_t pieces_by_points = 0, pieces_by_faces = 0;
  /// First percentile and median of the diameters of the largest balls in the part, at the voxels that are deepest in
  /// their neighbourhood; model units. For a layer of n voxels they are between n - 1/2 and n + 1/2.
  double thickness_p01 = 0, thickness_median = 0;
};

/// Measures a part. \pre the part has voxels
PartShape part_shape(const Grid& grid, const LabelPart& part);

}  // namespace umtet
