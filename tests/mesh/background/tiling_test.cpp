#include "mesh/background/tiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

std::array<Vec3, 4> corners(const Tiling& tiling, int t) {
  std::array<Vec3, 4> x;
  for (int k = 0; k < 4; ++k) {
    const auto& [type, offset] = tiling.tets[t][k];
    for (int a = 0; a < 3; ++a) x[k][a] = tiling.points[type][a] + offset[a] * tiling.period[a];
  }
  return x;
}

/// What is known of a tiling: counts a cell, extremes of dihedral angles in degrees and of quality.
struct Known {
  const char* name;
  std::size_t points, tets;
  std::array<double, 3> period;
  double least_deg, greatest_deg, least_quality, mean_quality;
};

const Known kKnown[] = {{"a15", 8, 46, {1, 1, 1}, 53.1301, 78.4630, .9449, .9769},
                        {"z", 14, 80, {4, 4 * std::sqrt(3.), 4}, 53.1301, 77.0790, .9600, .9805},
                        {"slab", 40, 224, {8, 4 * std::sqrt(3.), 9}, 49.5826, 77.9052, .9048, .9578},
                        {"cube", 1744, 9608, {2, 2, 2}, 43.3863, 87.1857, .6260, .9069}};

TEST(Tilings, FillSpace) {
  // Together with faces that match, which tables() sees to.
  for (const Known& known : kKnown) {
    const Tiling& tiling = tiling_named(known.name);
    EXPECT_EQ(tiling.name, known.name);
    EXPECT_EQ(tiling.points.size(), known.points);
    ASSERT_EQ(tiling.tets.size(), known.tets);
    double volume = 0, cell = 1;
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(tiling.period[a], known.period[a], 1e-14);
      cell *= known.period[a];
    }
    for (int t = 0; t < static_cast<int>(known.tets); ++t) {
      const auto x = corners(tiling, t);
      const double v6 = volume6(x[0], x[1], x[2], x[3]);
      ASSERT_GT(v6, 0) << known.name << ", tet " << t;
      volume += v6 / 6;
    }
    EXPECT_NEAR(volume / cell, 1, 1e-12) << known.name;
    EXPECT_NO_THROW(tables(tiling));
  }
}

TEST(Tilings, EveryDihedralAngleIsAcute) {
  for (const Known& known : kKnown) {
    const Tiling& tiling = tiling_named(known.name);
    double least = 180, greatest = 0, q_min = 1, q_sum = 0;
    for (int t = 0; t < static_cast<int>(tiling.tets.size()); ++t) {
      const auto x = corners(tiling, t);
      const DihedralRange range = dihedral_range(x[0], x[1], x[2], x[3]);
      least = std::min(least, range.min_deg), greatest = std::max(greatest, range.max_deg);
      const double q = mean_ratio(x[0], x[1], x[2], x[3]);
      q_min = std::min(q_min, q), q_sum += q;
    }
    EXPECT_NEAR(least, known.least_deg, 1e-4) << known.name;
    EXPECT_NEAR(greatest, known.greatest_deg, 1e-4) << known.name;
    EXPECT_NEAR(q_min, known.least_quality, 1e-4) << known.name;
    EXPECT_NEAR(q_sum / static_cast<double>(tiling.tets.size()), known.mean_quality, 1e-4) << known.name;
  }
}

TEST(Tilings, LinksAreSpheresAndTheMeanEdgeIsTheirs) {
  for (const Known& known : kKnown) {
    const Tiling& tiling = tiling_named(known.name);
    const TilingTables t = tables(tiling);
    double sum = 0;
    std::size_t n = 0;
    for (std::size_t type = 0; type < tiling.points.size(); ++type) {
      // A triangulated sphere of n vertices has 2 n - 4 triangles.
      ASSERT_EQ(t.star[type].size(), 2 * t.link[type].size() - 4) << known.name << ", type " << type;
      for (const auto& [other, offset] : t.link[type]) {
        Vec3 e;
        for (int a = 0; a < 3; ++a) {
          e[a] = tiling.points[other][a] + offset[a] * tiling.period[a] - tiling.points[type][a];
        }
        sum += e.norm(), ++n;
        EXPECT_FALSE(other == static_cast<int>(type)) << known.name << ": types do not colour the tiling";
      }
    }
    EXPECT_EQ(n, 2 * (tiling.points.size() + tiling.tets.size()));  // Euler characteristic 0
    EXPECT_NEAR(tiling.mean_edge, sum / static_cast<double>(n), 1e-12 * tiling.mean_edge) << known.name;
  }
  const TilingTables t = tables(a15());
  for (int type = 0; type < 8; ++type) {
    EXPECT_EQ(t.link[type].size(), type < 2 ? 12u : 14u);  // Frank-Kasper coordination of sites 2a and 6c
  }
}

/// True if no tet has corners on both sides of the plane.
bool is_mesh_plane(const Tiling& tiling, int axis, double at) {
  for (int t = 0; t < static_cast<int>(tiling.tets.size()); ++t) {
    bool below = false, above = false;
    for (const Vec3& x : corners(tiling, t)) below |= x[axis]<at, above |= x[axis]> at;
    if (below && above) return false;
  }
  return true;
}

TEST(Tilings, SlabsAndCubesHaveFlatWalls) {
  EXPECT_EQ(overhang(a15()), (std::array<double, 3>{.25, .25, .25}));
  EXPECT_EQ(overhang(acute_slab())[2], 0);
  EXPECT_EQ(overhang(acute_cube()), (std::array<double, 3>{0, 0, 0}));
  EXPECT_FALSE(is_mesh_plane(a15(), 2, .5));
  EXPECT_FALSE(is_mesh_plane(acute_slab(), 2, 4.5));
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(is_mesh_plane(acute_cube(), axis, 1)) << axis;
}

TEST(Tilings, HaveNames) {
  EXPECT_EQ(tiling_names().size(), std::size(kKnown));
  for (const std::string_view name : tiling_names()) EXPECT_EQ(tiling_named(name).name, name);
  EXPECT_THROW(tiling_named("bcc"), std::invalid_argument);
}

TEST(Tiling, AMissingTetIsRefused) {
  Tiling broken = a15();
  broken.tets.pop_back();
  EXPECT_THROW(tables(broken), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
