#include "reconstruct/level_set/label_parts.h"

#include <algorithm>
#include <unordered_map>

#include "reconstruct/level_set/voxel_distance.h"
#include "reconstruct/level_set/voxel_pieces.h"

namespace umtet {

std::vector<LabelPart> label_parts(const Grid& grid) {
  std::unordered_map<double, std::size_t> known;
  std::vector<LabelPart> parts;
  std::size_t at = 0;
  double last = 0;
  LabelPart* part = nullptr;
  for (int k = 0; k < grid.n[2]; ++k) {
    for (int j = 0; j < grid.n[1]; ++j) {
      for (int i = 0; i < grid.n[0]; ++i, ++at) {
        const double v = grid.values[at];
        if (v == 0) continue;
        const Eigen::Vector3i here(i, j, k);
        if (v != last || !part) {
          const auto [place, is_new] = known.try_emplace(v, parts.size());
          if (is_new) parts.push_back({v, 0, here, here, false});
          part = &parts[place->second];
          last = v;
        }
        ++part->n_voxels;
        part->first = part->first.cwiseMin(here);
        part->last = part->last.cwiseMax(here);
        if ((here.array() == 0).any() || (here.array() + 1 == grid.n.array()).any()) part->at_wall = true;
      }
    }
  }
  std::sort(parts.begin(), parts.end(), [](const LabelPart& a, const LabelPart& b) { return a.number < b.number; });
  return parts;
}

PartShape part_shape(const Grid& grid, const LabelPart& part) {
  // One layer around it, so that what is outside is there.
  VoxelMask mask;
  mask.n = part.last - part.first + Eigen::Vector3i::Constant(3);
  mask.inside.assign(static_cast<std::size_t>(mask.n[0]) * mask.n[1] * mask.n[2], 0);
  for (int k = part.first[2]; k <= part.last[2]; ++k) {
    for (int j = part.first[1]; j <= part.last[1]; ++j) {
      for (int i = part.first[0]; i <= part.last[0]; ++i) {
        const double v = grid.values[i + grid.n[0] * (j + static_cast<std::size_t>(grid.n[1]) * k)];
        const Eigen::Vector3i q = Eigen::Vector3i(i, j, k) - part.first + Eigen::Vector3i::Ones();
        mask.inside[mask.index(q[0], q[1], q[2])] = v == part.number ? 1 : 0;
      }
    }
  }
  PartShape shape;
  shape.pieces_by_points = voxel_pieces(mask, 1, VoxelNeighbours::Points).n();
  shape.pieces_by_faces = voxel_pieces(mask, 1, VoxelNeighbours::Faces).n();
  const std::vector<float> depth = voxel_distances(mask, grid.steps(), 0);
  std::vector<float> ridge;
  for (int k = 1; k + 1 < mask.n[2]; ++k) {
    for (int j = 1; j + 1 < mask.n[1]; ++j) {
      for (int i = 1; i + 1 < mask.n[0]; ++i) {
        const float d = depth[mask.index(i, j, k)];
        if (d == 0) continue;
        float most = 0;
        for (int q = 0; q < 27; ++q)
          most = std::max(most, depth[mask.index(i + q % 3 - 1, j + q / 3 % 3 - 1, k + q / 9 - 1)]);
        if (d >= most) ridge.push_back(d);
      }
    }
  }
  std::sort(ridge.begin(), ridge.end());
  // Of n voxels the middle is n / 2 or (n - 1) / 2 deep.
  const double half = .25 * grid.steps().minCoeff();
  shape.thickness_p01 = 2 * (ridge[ridge.size() / 100] + half);
  shape.thickness_median = 2 * (ridge[ridge.size() / 2] + half);
  return shape;
}

}  // namespace umtet
