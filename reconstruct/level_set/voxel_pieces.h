#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reconstruct/level_set/voxel_distance.h"

namespace umtet {

/// Connectivity of voxels: by common faces, or by any common points.
enum class VoxelNeighbours { Faces, Points };

/// Connected components of the voxels of one side.
struct VoxelPieces {
  std::vector<std::int32_t> piece;    ///< component of each voxel, ordered by first voxels; -1 for the other side
  std::vector<std::size_t> n_voxels;  ///< voxels of each component

  std::size_t n() const { return n_voxels.size(); }
};

/// Connected-component labelling. \throw std::length_error for a grid of 2^31 voxels or more
VoxelPieces voxel_pieces(const VoxelMask& mask, char side, VoxelNeighbours neighbours);

}  // namespace umtet
