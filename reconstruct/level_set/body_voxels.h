#pragma once

#include <optional>
#include <vector>

#include "reconstruct/level_set/grid.h"
#include "reconstruct/level_set/voxel_distance.h"

namespace umtet {

/// The voxels of a body, cut out of an image with some layers of voxels around them. The centre of voxel (i, j, k) is
/// origin + axes (i, j, k).
struct BodyVoxels {
  VoxelMask mask;
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();

  double voxel_volume() const;
  Vec3 steps() const { return axes.colwise().norm().transpose(); }
  Vec3 centre(int i, int j, int k) const { return origin + axes * Vec3(i, j, k); }
};

/// Cuts the inside voxels out of an image.
/// @param layers  number of layers of outside voxels around them, clipped to the image
/// @param part  the number of the body's voxels; none: all voxels that are not zero
/// \throw std::invalid_argument if no voxel is inside
BodyVoxels body_voxels(const Grid& grid, std::optional<double> part, int layers);

/// Returns the zeros of values at the centres, linearly between neighbours along an axis, model coordinates.
std::vector<Vec3> sign_changes(const BodyVoxels& voxels, const std::vector<float>& values);

}  // namespace umtet
