#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/vec3.h"

namespace umtet {

/// The number of connected pieces of a set of voxels, counted in two ways: voxels are connected if they share a point,
/// or only if they share a face. A smooth surface may join or separate voxels that share only a point or an edge, so
/// allows() accepts every number between the two counts.
struct PieceCount {
  std::size_t by_points = 0, by_faces = 0;  ///< by_points <= by_faces

  bool allows(std::size_t n) const { return by_points <= n && n <= by_faces; }
  bool operator==(const PieceCount&) const = default;
};

/// Comparison of a mesh with the voxels of the segmentation that it was made from.
struct LabelVolumeReport {
  std::optional<std::int64_t> part;  ///< label of the meshed part; empty if all labels other than 0 are meshed
  std::optional<double> kernel;      ///< standard deviation of mesh.part_smooth in voxels; empty if no kernel is used
  std::size_t n_voxels = 0;          ///< number of voxels in the body
  double volume_of_voxels = 0;       ///< total volume of these voxels, model units^3
  double volume_of_psi = 0;          ///< volume of {psi < 0}
  double volume_of_mesh = 0;         ///< total volume of the tets
  PieceCount pieces, cavities;       ///< pieces of the body; pieces of the outside, except the one around the body
  std::size_t pieces_of_mesh = 0;    ///< connected pieces of the tets; tets are connected by common vertices
  std::size_t cavities_of_mesh = 0;  ///< pieces of the boundary in excess of pieces_of_mesh
  std::size_t n_changed = 0;         ///< voxels whose centre is inside the mesh but not in the body, or the reverse
  std::size_t n_changed_far = 0;     ///< voxels of n_changed farther than half a voxel from the boundary
  double farthest_changed = 0;       ///< largest distance of a changed voxel from the boundary, in voxels
  std::optional<Vec3> farthest_at;   ///< position of the voxel with this distance; model coordinates
  bool operator==(const LabelVolumeReport&) const = default;
};

}  // namespace umtet
