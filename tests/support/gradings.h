#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "mesh/octree/graded_mesh.h"

namespace umtet::testing {

/// Every cube that may be split is, at random: all patterns of levels that balance allows, at n_levels levels.
/// A cube is split or not by its place alone, whatever the order of the calls.
inline Grading random_grading(std::uint64_t seed, int n_levels, double chance = .3) {
  Grading g;
  g.box = Eigen::AlignedBox3d(Vec3(-1, -2, 3), Vec3(1, 0, 5));
  g.finest = 2 * (6 + 8 * std::sqrt(.75)) / 14 / (1 << n_levels);
  g.size = [=](const Vec3& x, double half_width) {
    std::seed_seq place = {seed, static_cast<std::uint64_t>(std::llround(x[0] * 65536)),
                           static_cast<std::uint64_t>(std::llround(x[1] * 65536)),
                           static_cast<std::uint64_t>(std::llround(x[2] * 65536))};
    std::mt19937_64 random(place);
    const bool splits = half_width > .3 || std::uniform_real_distribution<>(0, 1)(random) < chance;
    return splits ? half_width : 4 * half_width;
  };
  g.tolerance = 1.0000001;  // of widths that are powers of two, to say which side of rounding is meant
  return g;
}

/// Sizes that grow with the distance from some points.
inline Grading spots(std::uint64_t seed, double finest, double growth, int n_spots = 3) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> coordinate(-1, 1);
  std::vector<Vec3> at;
  for (int i = 0; i < n_spots; ++i) at.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  Grading g;
  g.box = Eigen::AlignedBox3d(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  g.finest = finest;
  g.size = [=](const Vec3& x, double half_width) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& p : at) {
      const double distance = ((x - p).cwiseAbs().array() - half_width).max(0).matrix().norm();
      least = std::min(least, finest + growth * distance);
    }
    return least;
  };
  return g;
}

inline TetMesh to_tet_mesh(const GradedMesh& mesh) {
  TetMesh stored;
  for (std::int64_t v = 0; v < mesh.n_vertices(); ++v) stored.V.push_back(mesh.position(v));
  GradedMesh::Reader reader = mesh.reader();
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    const auto tet = reader.tet(t);
    stored.C.push_back(
        {static_cast<int>(tet[0]), static_cast<int>(tet[1]), static_cast<int>(tet[2]), static_cast<int>(tet[3])});
  }
  return stored;
}

}  // namespace umtet::testing
