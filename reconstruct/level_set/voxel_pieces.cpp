#include "reconstruct/level_set/voxel_pieces.h"

#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "common/disjoint_sets.h"

namespace umtet {

VoxelPieces voxel_pieces(const VoxelMask& mask, char side, VoxelNeighbours neighbours) {
  if (mask.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw std::length_error("too many voxels to count their pieces");
  std::vector<Eigen::Vector3i> before;  // neighbours that come earlier in the grid
  for (int k = -1; k <= 0; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const bool is_earlier = k < 0 || (k == 0 && (j < 0 || (j == 0 && i < 0)));
        const bool is_face = std::abs(i) + std::abs(j) + std::abs(k) == 1;
        if (is_earlier && (is_face || neighbours == VoxelNeighbours::Points)) before.push_back({i, j, k});
      }
    }
  }
  DisjointSets sets(mask.size());
  const Eigen::Vector3i& n = mask.n;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const auto at = static_cast<std::int32_t>(mask.index(i, j, k));
        if (mask.inside[at] != side) continue;
        for (const Eigen::Vector3i& o : before) {
          const Eigen::Vector3i q(i + o[0], j + o[1], k + o[2]);
          if ((q.array() < 0).any() || (q.array() >= n.array()).any()) continue;
          const auto other = static_cast<std::int32_t>(mask.index(q[0], q[1], q[2]));
          if (mask.inside[other] == side) sets.unite(at, other);
        }
      }
    }
  }
  VoxelPieces pieces;
  pieces.piece.assign(mask.size(), -1);
  for (std::size_t at = 0; at < mask.size(); ++at) {
    if (mask.inside[at] != side) continue;
    const auto first = static_cast<std::size_t>(sets.find(static_cast<int>(at)));
    if (first == at) {
      pieces.piece[at] = static_cast<std::int32_t>(pieces.n_voxels.size());
      pieces.n_voxels.push_back(0);
    }
    ++pieces.n_voxels[pieces.piece[at] = pieces.piece[first]];
  }
  return pieces;
}

}  // namespace umtet
