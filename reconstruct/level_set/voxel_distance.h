#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// Binary mask of voxels, first axis fastest: 1 inside, 0 outside.
struct VoxelMask {
  Eigen::Vector3i n = Eigen::Vector3i::Zero();
  std::vector<char> inside;

  std::size_t size() const { return inside.size(); }
  std::ptrdiff_t index(int i, int j, int k) const {
    return i + static_cast<std::ptrdiff_t>(n[0]) * (j + static_cast<std::ptrdiff_t>(n[1]) * k);
  }
};

/// Distance transform: distance from the centre of every voxel to the nearest centre of a voxel with value `is_there`;
/// infinite if there is none. Exact, in linear time.              [FelzenszwalbHuttenlocher2012]
/// @param steps  size of a voxel along each axis; the axes are taken as orthogonal
std::vector<double> centre_distances(const VoxelMask& mask, const Vec3& steps, char is_there);

/// Distance from the centre of every voxel to the nearest point of a voxel with value `is_there`: 0 in these voxels,
/// infinite if there is none. Exact, in linear time. Along each axis the square of max(|i - j| - 1/2, 0) step is the
/// minimum over the two faces of voxel j.
std::vector<float> voxel_distances(const VoxelMask& mask, const Vec3& steps, char is_there);

/// Signed distance from the centre of every voxel to the faces between inside and outside, negative inside.
/// \pre there are voxels of both kinds
std::vector<float> signed_face_distances(const VoxelMask& mask, const Vec3& steps);

}  // namespace umtet
