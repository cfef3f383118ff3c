// Distances between voxels, and their pieces.

#include "reconstruct/level_set/voxel_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "reconstruct/level_set/voxel_pieces.h"

using namespace umtet;

namespace {

VoxelMask random_mask(const Eigen::Vector3i& n, double share) {
  VoxelMask mask{n, {}};
  std::mt19937 random(3);
  std::bernoulli_distribution inside(share);
  for (int i = 0; i < n.prod(); ++i) mask.inside.push_back(inside(random) ? 1 : 0);
  return mask;
}

Eigen::Vector3i place(const VoxelMask& mask, std::size_t at) {
  const auto i = static_cast<int>(at);
  return {i % mask.n[0], i / mask.n[0] % mask.n[1], i / mask.n[0] / mask.n[1]};
}

}  // namespace

TEST(VoxelDistance, IsTheLeastOfAllDistances) {
  const VoxelMask mask = random_mask({9, 7, 8}, .05);
  const Vec3 steps(1, .7, 2);
  const std::vector<double> to_centres = centre_distances(mask, steps, 1);
  const std::vector<float> to_voxels = voxel_distances(mask, steps, 1);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    double centre = std::numeric_limits<double>::infinity(), voxel = centre;
    for (std::size_t j = 0; j < mask.size(); ++j) {
      if (!mask.inside[j]) continue;
      const Vec3 apart = (place(mask, i) - place(mask, j)).cast<double>().cwiseAbs();
      centre = std::min(centre, apart.cwiseProduct(steps).norm());
      voxel = std::min(voxel, (apart.array() - .5).max(0).matrix().cwiseProduct(steps).norm());
    }
    EXPECT_NEAR(to_centres[i], centre, 1e-12);
    EXPECT_NEAR(to_voxels[i], voxel, 1e-5);
  }
}

TEST(VoxelDistance, FacesAreHalfAStepFromCentresOnBothSides) {
  VoxelMask mask{{8, 8, 8}, std::vector<char>(512, 0)};
  for (std::size_t i = 0; i < 256; ++i) mask.inside[i] = 1;  // k < 4
  const std::vector<float> d = signed_face_distances(mask, Vec3(1, 1, 3));
  for (std::size_t i = 0; i < 512; ++i) EXPECT_FLOAT_EQ(d[i], 3 * (static_cast<float>(i / 64) - 3.5F));
}

TEST(VoxelDistance, IsInfiniteWithoutVoxels) {
  const VoxelMask mask{{6, 6, 6}, std::vector<char>(216, 0)};
  EXPECT_EQ(voxel_distances(mask, Vec3::Ones(), 1)[7], std::numeric_limits<float>::infinity());
  EXPECT_EQ(centre_distances(mask, Vec3::Ones(), 1)[7], std::numeric_limits<double>::infinity());
}

TEST(VoxelPieces, VoxelsWithACommonPointOrFaceAreOnePiece) {
  VoxelMask mask{{6, 6, 6}, std::vector<char>(216, 0)};
  for (const auto& [i, j, k] : {std::array{1, 1, 1}, {2, 1, 1}, {3, 2, 1}, {4, 3, 2}, {1, 4, 4}})
    mask.inside[mask.index(i, j, k)] = 1;
  const VoxelPieces by_points = voxel_pieces(mask, 1, VoxelNeighbours::Points);
  EXPECT_EQ(by_points.n_voxels, (std::vector<std::size_t>{4, 1}));
  EXPECT_EQ(by_points.piece[mask.index(4, 3, 2)], 0);
  EXPECT_EQ(by_points.piece[mask.index(0, 0, 0)], -1);
  EXPECT_EQ(voxel_pieces(mask, 1, VoxelNeighbours::Faces).n_voxels, (std::vector<std::size_t>{2, 1, 1, 1}));
  EXPECT_EQ(voxel_pieces(mask, 0, VoxelNeighbours::Faces).n(), 1U);
}

TEST(VoxelPieces, AllVoxelsAreCounted) {
  const VoxelMask mask = random_mask({20, 20, 20}, .3);
  for (const char side : {char(0), char(1)}) {
    for (const VoxelNeighbours neighbours : {VoxelNeighbours::Points, VoxelNeighbours::Faces}) {
      const VoxelPieces pieces = voxel_pieces(mask, side, neighbours);
      std::size_t n = 0;
      for (const std::size_t of_piece : pieces.n_voxels) n += of_piece;
      EXPECT_EQ(n, static_cast<std::size_t>(std::count(mask.inside.begin(), mask.inside.end(), side)));
    }
  }
}
