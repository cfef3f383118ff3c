#include "reconstruct/triangles/sliver_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "reconstruct/triangles/sharp_edges.h"
#include "reconstruct/triangles/triangle_body.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

double least_height(const TriangleMesh& mesh) {
  double least = 1e300;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k)).norm());
    least = std::min(least, 2 * mesh.area_vector(f).norm() / longest);
  }
  return least;
}

/// Divides the first triangle at a point `off` beside the middle of its first side: a cap, whose neighbour keeps its
/// side.
TriangleMesh with_cap(TriangleMesh mesh, double off) {
  const Triangle t = mesh.F[0];
  const Vec3 middle = (mesh.V[t[0]] + mesh.V[t[1]]) / 2;
  const int v = static_cast<int>(mesh.V.size());
  mesh.V.push_back(middle + off * (mesh.V[t[2]] - middle).normalized());
  mesh.F[0] = {t[0], t[1], v};
  mesh.F.push_back({t[1], t[2], v});
  mesh.F.push_back({t[2], t[0], v});
  return mesh;
}

TEST(SliverRepair, ACapIsFlippedAway) {
  const TriangleMesh cube = test::cube();
  TriangleMesh mesh = with_cap(cube, 1e-9);
  const TriangleBody before = measure_body(mesh);
  EXPECT_EQ(remove_slivers(mesh, 1e-6), 1u);
  EXPECT_GT(least_height(mesh), 1e-3);
  const TriangleBody after = measure_body(mesh);
  EXPECT_EQ(mesh.F.size(), cube.F.size() + 2);
  EXPECT_TRUE(after.is_closed && after.is_manifold);
  EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
  EXPECT_NEAR(after.volume, before.volume, 1e-8);
  EXPECT_EQ(find_sharp_edges(mesh).n_patches, 6u);
}

TEST(SliverRepair, LinesAndLabelsStayWhereTheyAre) {
  // The cap of an edge of the square: flat, and on the line.
  for (const double off : {1e-9, -1e-9}) {
    TriangleMesh mesh = test::cube_with_imprint();
    const auto at =
        std::find_if(mesh.F.begin(), mesh.F.end(), [](const Triangle& f) { return f[0] == 8 && f[1] == 9; });
    std::rotate(mesh.F.begin(), at, mesh.F.end());
    std::rotate(mesh.labels.begin(), mesh.labels.begin() + (mesh.F.size() - 2), mesh.labels.end());
    mesh.lines = {{8, 9}, {9, 10}, {10, 11}, {11, 8}};
    mesh = with_cap(mesh, off);
    mesh.labels.insert(mesh.labels.end(), {2, 2});
    EXPECT_EQ(remove_slivers(mesh, 1e-6), 1u);
    EXPECT_EQ(mesh.lines.size(), 5u);
    const SharpEdges edges = find_sharp_edges(mesh);
    EXPECT_EQ(edges.n_curves_by(SharpCurve::Reason::Line), 4u);
    EXPECT_EQ(edges.n_curves_by(SharpCurve::Reason::Border), 0u);
    EXPECT_EQ(edges.n_patches, 7u);
  }
}

TEST(SliverRepair, ANeedleCollapses) {
  // A needle: two vertices almost at one place, in the middle of a face.
  TriangleMesh mesh = with_cap(test::cube(), .2);
  const int v = static_cast<int>(mesh.V.size());
  const Triangle t = mesh.F[0];
  mesh.V.push_back(mesh.V[t[2]] + 1e-9 * (mesh.V[t[0]] - mesh.V[t[2]]).normalized());
  mesh.F[0] = {t[0], t[1], v};
  mesh.F.push_back({t[1], t[2], v});
  mesh.F.push_back({t[2], t[0], v});
  EXPECT_GT(remove_slivers(mesh, 1e-6), 0u);
  EXPECT_GT(least_height(mesh), 1e-3);
  const TriangleBody after = measure_body(mesh);
  EXPECT_TRUE(after.is_closed && after.is_manifold);
  EXPECT_EQ(after.euler_characteristic, 2);
}

TEST(SliverRepair, GoodTrianglesStay) {
  TriangleMesh mesh = test::cube();
  const auto before = mesh.F;
  EXPECT_EQ(remove_slivers(mesh, 1e-6), 0u);
  EXPECT_EQ(mesh.F, before);
}

}  // namespace
}  // namespace umtet
