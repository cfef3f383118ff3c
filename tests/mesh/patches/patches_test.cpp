#include "mesh/patches/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/io/solver_mesh.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

SolverMesh box() {
  return solver_mesh(testing::cubes(4, [](int, int, int) { return true; }));
}

TEST(SmoothPieces, ABoxHasSixSidesAndOneSurface) {
  const SolverMesh mesh = box();
  const std::vector<int> sides = smooth_pieces(mesh.nodes, mesh.triangles(), 89),
                         whole = smooth_pieces(mesh.nodes, mesh.triangles(), 180);
  EXPECT_EQ(*std::max_element(sides.begin(), sides.end()), 5);
  EXPECT_EQ(*std::max_element(whole.begin(), whole.end()), 0);
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  for (std::size_t f = 1; f < mesh.n_faces(); ++f) {
    for (std::size_t g = 0; g < f; ++g) {
      EXPECT_EQ(sides[f] == sides[g], faces.normal[f].dot(faces.normal[g]) > .5);
    }
  }
}

TEST(SmoothPieces, TheLargestComesFirst) {
  // A wall of a cavity is shorter than the outside; it has the least vertices only in the middle of the numbering.
  const TetMesh hollow = testing::cubes(5, [](int i, int j, int k) { return i != 2 || j != 2 || k != 2; });
  const SolverMesh mesh = solver_mesh(hollow);
  const std::vector<int> pieces = smooth_pieces(mesh.nodes, mesh.triangles(), 180);
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  double area[2] = {0, 0};
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) area[pieces.at(f)] += faces.area[f];
  EXPECT_NEAR(area[0], 150, 1e-12);
  EXPECT_NEAR(area[1], 6, 1e-12);
}

TEST(AbsorbIslands, IslandsTakeTheLabelTheyBorderOnMost) {
  const SolverMesh mesh = box();
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  std::vector<int> half, spotted;
  for (const Vec3& x : faces.centroid) {
    half.push_back(x.x() < 2 ? -4 : 9);
    // A square of area 1 on the top of the left half, of two triangles with labels of their own.
    const bool spot = x.z() > 3.9 && x.x() < 1 && x.y() > 1 && x.y() < 2;
    spotted.push_back(!spot ? half.back() : x.x() > x.y() - 1 ? 5 : 9);
  }
  std::vector<int> labels = spotted;
  absorb_islands(mesh.nodes, mesh.triangles(), 1.5, labels);
  EXPECT_EQ(labels, half);
  labels = spotted;
  absorb_islands(mesh.nodes, mesh.triangles(), 0, labels);
  EXPECT_EQ(labels, spotted);
  labels = half;
  absorb_islands(mesh.nodes, mesh.triangles(), 1e9, labels);  // one label is left, whatever the area
  EXPECT_EQ(std::count(labels.begin(), labels.end(), labels[0]), static_cast<std::ptrdiff_t>(labels.size()));
  labels.pop_back();
  EXPECT_THROW(absorb_islands(mesh.nodes, mesh.triangles(), 1, labels), std::invalid_argument);
}

TEST(AbsorbIslands, WhatTwoIslandsMakeIsStillAnIsland) {
  const SolverMesh mesh = box();
  std::vector<int> labels, expected;
  for (const Vec3& x : face_geometry(mesh.nodes, mesh.triangles()).centroid) {
    // Both triangles of the square border on each other most; the square borders equally on four labels.
    const bool spot = x.z() > 3.9 && x.x() > 1 && x.x() < 2 && x.y() > 1 && x.y() < 2;
    const int around = x.y() < 1 ? 1 : x.x() > 2 ? 2 : x.y() > 2 ? 3 : 4;
    labels.push_back(!spot ? around : x.x() > x.y() ? 5 : 6);
    expected.push_back(spot ? 1 : around);
  }
  absorb_islands(mesh.nodes, mesh.triangles(), 1.5, labels);
  EXPECT_EQ(labels, expected);
}

}  // namespace
}  // namespace umtet
