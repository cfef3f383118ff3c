#include "mesh/certify/boundary_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

SurfaceTopology surface_of(const TetMesh& mesh) {
  return surface_topology(mesh.V, boundary_faces(mesh.C, mesh.V.size()).triangles);
}

TEST(BoundaryFaces, OfABallAreItsSphereSeenFromOutside) {
  std::vector<Triangle> sphere;
  const TetMesh mesh = testing::ball(2, sphere);
  const BoundaryFaces surface = boundary_faces(mesh.C, mesh.V.size());
  EXPECT_EQ(surface.triangles.size(), sphere.size());
  EXPECT_EQ(surface.n_overused, 0u);
  EXPECT_EQ(surface.n_same_side, 0u);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Triangle& f = surface.triangles[i];
    const Vec3 &a = mesh.V[f[0]], &b = mesh.V[f[1]], &c = mesh.V[f[2]];
    EXPECT_GT((b - a).cross(c - a).dot(a), 0);
    const Tet& t = mesh.C[surface.tets[i]];
    for (const int v : f) EXPECT_NE(std::find(t.begin(), t.end(), v), t.end());
  }
}

TEST(BoundaryFaces, AThirdTetOnAFaceAndATetOnTheSameSideAreCounted) {
  // Three tets on face 0 1 2: two above, one below.
  EXPECT_EQ(boundary_faces({{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}}, 6).n_overused, 1u);
  const BoundaryFaces overlap = boundary_faces({{0, 1, 2, 3}, {0, 1, 2, 4}}, 5);
  EXPECT_EQ(overlap.n_same_side, 1u);
  EXPECT_EQ(overlap.n_overused, 0u);
  EXPECT_EQ(boundary_faces({{0, 1, 2, 3}, {0, 2, 1, 4}}, 5).n_same_side, 0u);
}

/// The same by a map of all faces.
BoundaryFaces counted_one_by_one(const std::vector<Tet>& C) {
  std::map<Triangle, std::vector<std::pair<int, int>>> uses;
  for (std::size_t t = 0; t < C.size(); ++t) {
    for (const auto& f : kTetFace) {
      Triangle face = {C[t][f[0]], C[t][f[1]], C[t][f[2]]}, key = face;
      std::sort(key.begin(), key.end());
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      uses[key].emplace_back(static_cast<int>(t), face == key);
    }
  }
  BoundaryFaces result;
  for (const auto& [face, by] : uses) {
    if (by.size() == 1) result.tets.push_back(by[0].first);
    if (by.size() == 2) result.n_same_side += by[0].second == by[1].second;
    if (by.size() > 2) ++result.n_overused;
  }
  std::sort(result.tets.begin(), result.tets.end());
  return result;
}

void expect_count_one_by_one(const std::vector<Tet>& C, std::size_t n_vertices) {
  const BoundaryFaces ours = boundary_faces(C, n_vertices), theirs = counted_one_by_one(C);
  EXPECT_EQ(ours.tets, theirs.tets);
  EXPECT_EQ(ours.n_same_side, theirs.n_same_side);
  EXPECT_EQ(ours.n_overused, theirs.n_overused);
}

TEST(BoundaryFaces, AreThoseOfACountOneByOne) {
  // Vertices of several blocks in any order, and one with more faces than are matched by hashing.
  TetMesh mesh = testing::cubes(17, [](int i, int j, int k) { return i + j + k > 2; });
  std::vector<int> order(mesh.V.size() + 102);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(1);
  std::shuffle(order.begin() + 102, order.end(), random);
  for (Tet& t : mesh.C) {
    for (int& v : t) v = order[v + 102];
  }
  for (int k = 1; k <= 100; ++k) mesh.C.push_back({0, k, k % 100 + 1, 101});  // around the edge from 0 to 101
  std::vector<std::vector<Tet>> meshes(4, mesh.C);
  meshes[1].insert(meshes[1].end(), {mesh.C[0], mesh.C[5000], mesh.C.back(), mesh.C[20000]});  // some twice
  for (const std::size_t t : {1u, 9000u, 9001u, 29000u}) std::swap(meshes[2][t][0], meshes[2][t][1]);
  for (const std::size_t t : {2u, 8000u, 20001u}) meshes[3][t] = mesh.C[t + 40];
  for (const auto& C : meshes) expect_count_one_by_one(C, order.size());
}

TEST(BoundaryFaces, DamageInTheRowsOfALatticeIsSeen) {
  // Faces under a vertex are not matched where they repeat those under the last one: what is changed does not repeat,
  // and what repeats a gap is one.
  const TetMesh mesh = testing::cubes(17, [](int i, int j, int k) { return i + j + k > 2; });
  const std::size_t n = mesh.C.size();
  expect_count_one_by_one(mesh.C, mesh.V.size());
  std::mt19937 random(2);
  for (int round = 0; round < 8; ++round) {
    std::vector<Tet> C = mesh.C;
    for (int k = 0; k < 12; ++k) {
      Tet& t = C[random() % n];
      if (round % 4 == 0) std::swap(t[0], t[1]);
      if (round % 4 == 1) t = mesh.C[random() % n];
      if (round % 4 == 2) t[random() % 4] = static_cast<int>(random() % mesh.V.size());
      if (round % 4 == 3) C.push_back(Tet(t));
    }
    std::erase_if(C, [](const Tet& t) { return std::set<int>(t.begin(), t.end()).size() < 4; });
    expect_count_one_by_one(C, mesh.V.size());
  }
  std::vector<Tet> gaps;  // some thousand cubes lack the same one of their six tets
  for (std::size_t t = 0; t < n; ++t) {
    if (t % 6 != 1 || t < n / 3 || t > n / 2) gaps.push_back(mesh.C[t]);
  }
  expect_count_one_by_one(gaps, mesh.V.size());
}

TEST(BoundaryFaces, RefusesIndicesThatDoNotExist) {
  EXPECT_THROW(boundary_faces({{0, 1, 2, 4}}, 4), std::invalid_argument);
  EXPECT_THROW(boundary_faces({{0, 1, 2, -1}}, 4), std::invalid_argument);
  EXPECT_THROW(boundary_faces({{0, 1, 2, 2}}, 4), std::invalid_argument);
}

TEST(SurfaceTopology, BallBlockRingAndDoubleRingHaveTheirGenus) {
  std::vector<Triangle> sphere;
  const SurfaceTopology ball = surface_of(testing::ball(3, sphere));
  EXPECT_TRUE(ball.closed_manifold);
  EXPECT_EQ(ball.euler_characteristic, 2);
  EXPECT_EQ(ball.genus, 0);
  EXPECT_NEAR(ball.area, 4 * std::numbers::pi, 0.02 * 4 * std::numbers::pi);  // 512 faces: measured 1.3 % below

  const SurfaceTopology ring =
      surface_of(testing::cubes(3, [](int i, int j, int k) { return k == 0 && !(i == 1 && j == 1); }));
  EXPECT_TRUE(ring.closed_manifold);
  EXPECT_EQ(ring.euler_characteristic, 0);
  EXPECT_EQ(ring.genus, 1);
  EXPECT_NEAR(ring.area, 2 * 8 + 12 + 4, 1e-12);
  EXPECT_NEAR(ring.components[0].volume, 8, 1e-12);

  const SurfaceTopology two = surface_of(
      testing::cubes(5, [](int i, int j, int k) { return k == 0 && j < 3 && !((i == 1 || i == 3) && j == 1); }));
  EXPECT_TRUE(two.closed_manifold);
  EXPECT_EQ(two.genus, 2);
}

TEST(SurfaceTopology, ACavityIsAComponentOfNegativeVolume) {
  const SurfaceTopology s =
      surface_of(testing::cubes(3, [](int i, int j, int k) { return !(i == 1 && j == 1 && k == 1); }));
  EXPECT_TRUE(s.closed_manifold);
  ASSERT_EQ(s.components.size(), 2u);
  EXPECT_EQ(s.euler_characteristic, 4);
  EXPECT_NEAR(s.components[0].volume, 27, 1e-12);
  EXPECT_NEAR(s.components[1].volume, -1, 1e-12);
}

TEST(SurfaceTopology, BodiesThatTouchInAVertexOrAnEdgeAreNoManifold) {
  const SurfaceTopology vertex = surface_of(testing::cubes(2, [](int i, int j, int k) { return i == j && j == k; }));
  EXPECT_FALSE(vertex.closed_manifold);
  EXPECT_EQ(vertex.n_nonmanifold_vertices, 1u);
  EXPECT_EQ(vertex.n_nonmanifold_edges, 0u);
  EXPECT_EQ(vertex.components.size(), 1u);

  const SurfaceTopology edge = surface_of(testing::cubes(2, [](int i, int j, int k) { return i == j && k == 0; }));
  EXPECT_FALSE(edge.closed_manifold);
  EXPECT_EQ(edge.n_nonmanifold_edges, 1u);
}

TEST(SurfaceTopology, AHoleAndAFlippedFaceAreSeen) {
  std::vector<Triangle> faces;
  const TetMesh sphere = testing::sphere_surface(1, faces);
  std::vector<Triangle> holed(faces.begin() + 1, faces.end());
  EXPECT_EQ(surface_topology(sphere.V, holed).n_nonmanifold_edges, 3u);
  EXPECT_FALSE(surface_topology(sphere.V, holed).closed_manifold);
  std::swap(faces[0][0], faces[0][1]);
  EXPECT_EQ(surface_topology(sphere.V, faces).n_misoriented_edges, 3u);
  EXPECT_FALSE(surface_topology(sphere.V, faces).closed_manifold);
}

}  // namespace
}  // namespace umtet
