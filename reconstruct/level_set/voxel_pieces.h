#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reconstruct/level_set/voxel_distance.h"

namespace umtet {

/// What makes two voxels neighbours: a common face, or any common point.
enum class VoxelNeighbours { Faces, Points };

/// The connected pieces of the voxels of one side.
struct VoxelPieces {
  std::vector<std::int32_t> piece;    ///< of each voxel, -1 for those of the other side; in the order of first voxels
  std::vector<std::size_t> n_voxels;  ///< of each piece

  std::size_t n() const { return n_voxels.size(); }
};

/// \throw std::length_error  a grid of 2^31 voxels or more
VoxelPieces voxel_pieces(const VoxelMask& mask, char side, VoxelNeighbours neighbours);

}  // namespace umtet
