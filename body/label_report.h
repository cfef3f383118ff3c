#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/vec3.h"

namespace umtet {

/// A count of pieces of voxels: fewer where voxels hold together that have a common point, more where they need a
/// common face. A smooth surface may join or part voxels that have less than a face in common.
struct PieceCount {
  std::size_t by_points = 0, by_faces = 0;

  bool allows(std::size_t n) const { return by_points <= n && n <= by_faces; }
  bool operator==(const PieceCount&) const = default;
};

/// The voxels of a segmentation that were meshed beside the mesh.
struct LabelVolumeReport {
  std::optional<std::int64_t> part;  ///< its number; none: all that is not 0
  std::optional<double> kernel;      ///< standard deviation of mesh.part_smooth in voxels; none: no kernel
  std::size_t n_voxels = 0;          ///< of the body
  double volume_of_voxels = 0;       ///< of all of them together, model units^3
  double volume_of_psi = 0;          ///< of {psi < 0}
  double volume_of_mesh = 0;         ///< of its tets
  PieceCount pieces, cavities;       ///< of the body; of what is outside, without the piece around the body
  std::size_t pieces_of_mesh = 0;    ///< of its tets, by common vertices
  std::size_t cavities_of_mesh = 0;  ///< pieces of its boundary that are none of these
  std::size_t n_changed = 0;         ///< voxels of the body and around it whose centre is on the other side of the mesh
  std::size_t n_changed_far = 0;     ///< those farther than half a voxel from its boundary
  double farthest_changed = 0;       ///< of all of them, in voxels
  std::optional<Vec3> farthest_at;   ///< where that is; model coordinates
  bool operator==(const LabelVolumeReport&) const = default;
};

}  // namespace umtet
