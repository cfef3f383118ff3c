// Edges of meshes whose edges are known.

#include "pipeline/meshing/mesh_sizes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace umtet {
namespace {

/// Edges of 1 from the origin, of sqrt(2) between the others.
const TetMesh kCorner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};

TEST(MeshSizes, MeanEdgesAreOfEachVertex) {
  const std::vector<double> mean = mean_edges(kCorner.V, kCorner.C);
  EXPECT_DOUBLE_EQ(mean[0], 1);
  for (int i = 1; i < 4; ++i) EXPECT_DOUBLE_EQ(mean[i], (1 + 2 * std::sqrt(2.)) / 3);
}

TEST(MeshSizes, TheReportHasWhatWasAskedForAndWhatWasMade) {
  const SizesReport r = sizes_report(kCorner, {{0, 1, 2}}, {.5, .5, .5, .5});
  EXPECT_DOUBLE_EQ(r.p50, (1 + std::sqrt(2.)) / 2 / .5);  // between three and three
  EXPECT_DOUBLE_EQ(r.p01, 2);
  EXPECT_DOUBLE_EQ(r.shortest_boundary_edge, 1);
  EXPECT_DOUBLE_EQ(r.longest_boundary_edge, std::sqrt(2.));
  EXPECT_EQ(r.least_asked, .5);
}

TEST(MeshSizes, AreAskedOfTheField) {
  const SizeField field({{{0, 0, 0}, .1}}, {.grade = .3, .h_min = .01, .h_max = 1});
  const std::vector<double> asked = asked_sizes(field, kCorner.V);
  EXPECT_NEAR(asked[0], .1, .005);
  EXPECT_NEAR(asked[1], .4, .02);
}

}  // namespace
}  // namespace umtet
