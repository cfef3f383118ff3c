#include "mesh/embedding/self_intersections.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/embedding/triangle_intersection.h"
#include "tests/support/box_tets.h"

namespace umtet {
namespace {

using Pairs = std::vector<std::array<int, 2>>;

MeshCertificate certificate_of(const TetMesh& mesh) {
  CertificateInput input;
  input.mesh = &mesh;
  return certify(input);
}

bool meet(const Triangle& f, const Triangle& g, const std::vector<Vec3>& V) {
  const bool answer = meet_beyond_shared(V, f, g);
  EXPECT_EQ(answer, meet_beyond_shared(V, g, f));
  EXPECT_EQ(answer, meet_beyond_shared(V, {f[2], f[1], f[0]}, {g[1], g[2], g[0]}));
  return answer;
}

TEST(SelfIntersections, PairsThatShareNothing) {
  const std::vector<Vec3> V = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0},  {1, 1, -1}, {1, 1, 1}, {9, 9, 1},
                               {1, 1, 0}, {2, 1, 0}, {1, 2, 0},  {5, 0, 0},  {6, 0, 0}, {5, 1, 0},
                               {4, 0, 0}, {5, 0, 1}, {5, 0, -1}, {2, 2, 0},  {3, 3, 0}, {3, 2, 5}};
  const Triangle base = {0, 1, 2};
  EXPECT_TRUE(meet(base, {3, 4, 5}, V));     // an edge goes through
  EXPECT_FALSE(meet(base, {4, 5, 17}, V));   // above
  EXPECT_TRUE(meet(base, {6, 7, 8}, V));     // in its plane, within
  EXPECT_FALSE(meet(base, {9, 10, 11}, V));  // in its plane, beside
  EXPECT_TRUE(meet(base, {12, 13, 14}, V));  // touches a corner that is another vertex
  EXPECT_TRUE(meet(base, {15, 16, 17}, V));  // touches an edge with a corner
}

TEST(SelfIntersections, PairsThatShareAVertex) {
  const std::vector<Vec3> V = {{0, 0, 0},  {4, 0, 0},  {0, 4, 0}, {1, 1, -1}, {1, 1, 1},
                               {-1, 0, 1}, {-1, 1, 0}, {1, 1, 0}, {1, 5, 0},  {8, 1, 0}};
  const Triangle base = {0, 1, 2};
  EXPECT_TRUE(meet(base, {0, 3, 4}, V));   // its far edge goes through
  EXPECT_FALSE(meet(base, {0, 4, 5}, V));  // above
  EXPECT_FALSE(meet(base, {0, 5, 6}, V));
  EXPECT_TRUE(meet(base, {0, 7, 6}, V));  // in its plane, overlapping
  EXPECT_TRUE(meet(base, {0, 9, 8}, V));  // in its plane, around it
  EXPECT_TRUE(meet(base, {0, 7, 4}, V));  // touches it along a segment
}

TEST(SelfIntersections, PairsThatShareAnEdge) {
  const std::vector<Vec3> V = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, -1, 0}, {1, 1, 1e-300}, {1, 1, -1}};
  const Triangle base = {0, 1, 2};
  EXPECT_TRUE(meet(base, {1, 0, 3}, V));   // folded on to it
  EXPECT_FALSE(meet(base, {1, 0, 4}, V));  // flat
  EXPECT_FALSE(meet(base, {1, 0, 5}, V));  // folded, but for the least bit
  EXPECT_FALSE(meet(base, {1, 0, 6}, V));
}

/// Against all pairs, of triangles that are small or large, some of them flat in a grid's planes.
TEST(SelfIntersections, TheTreeFindsAllPairs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const bool snapped : {false, true}) {
    std::vector<Vec3> V;
    std::vector<Triangle> faces;
    for (int k = 0; k < 400; ++k) {
      const Vec3 at(any(random), any(random), any(random));
      const double size = k % 20 == 0 ? 1 : .2;
      for (int c = 0; c < 3; ++c) {
        Vec3 x = at + size * Vec3(any(random), any(random), any(random));
        if (snapped) x = (x * 8).array().round() / 8;
        V.push_back(x);
      }
      if ((V[3 * k + 1] - V[3 * k]).cross(V[3 * k + 2] - V[3 * k]).norm() > 0)
        faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    Pairs expected;
    for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
      for (int g = f + 1; g < static_cast<int>(faces.size()); ++g) {
        if (meet_beyond_shared(V, faces[f], faces[g])) expected.push_back({f, g});
      }
    }
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(self_intersections(V, faces), expected);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(self_intersections(V, faces), expected);
  }
}

/// A long box bent by `turn` around the y axis, rising by `rise`: all tets positive.
TetMesh bent_bar(double turn, double rise) {
  TetMesh mesh = testing::box_tets({0, -.1, -.1}, {1, .1, .1}, {60, 3, 3});
  for (Vec3& x : mesh.V) {
    const double a = turn * x.x(), r = 1 + x.z();
    x = Vec3(r * std::sin(a), x.y() + rise * x.x(), r * std::cos(a));
  }
  return mesh;
}

TEST(Embedding, ATubeBentThroughItself) {
  const MeshCertificate free = certificate_of(bent_bar(.9 * 2 * std::numbers::pi, 0));
  EXPECT_TRUE(free.is_embedded());
  EXPECT_EQ(free.boundary.n_self_intersections, 0u);
  const MeshCertificate helix = certificate_of(bent_bar(1.3 * 2 * std::numbers::pi, .5));
  EXPECT_TRUE(helix.is_embedded());
  const MeshCertificate bent = certificate_of(bent_bar(1.3 * 2 * std::numbers::pi, .1));
  EXPECT_EQ(bent.quality.n_inverted, 0u);
  EXPECT_TRUE(bent.boundary.closed_manifold);
  EXPECT_GT(bent.boundary.n_self_intersections, 10u);
  EXPECT_FALSE(bent.is_embedded());
  EXPECT_EQ(invalidities(bent).size(), 1u);
}

// Twice around, exactly on itself but for the ends: every face of one turn has one of the other in its place.
TEST(Embedding, ADoubleCover) {
  const MeshCertificate twice = certificate_of(bent_bar(2 * 2 * std::numbers::pi, 0));
  EXPECT_EQ(twice.quality.n_inverted, 0u);
  EXPECT_TRUE(twice.boundary.closed_manifold);
  EXPECT_GT(twice.boundary.n_self_intersections, 500u);
}

TetMesh joined(const TetMesh& a, const TetMesh& b) {
  TetMesh mesh = a;
  const int n = static_cast<int>(a.V.size());
  mesh.V.insert(mesh.V.end(), b.V.begin(), b.V.end());
  for (const Tet& t : b.C) mesh.C.push_back({t[0] + n, t[1] + n, t[2] + n, t[3] + n});
  return mesh;
}

TetMesh cube(double half, const Vec3& at = Vec3::Zero()) {
  return testing::box_tets(at - Vec3::Constant(half), at + Vec3::Constant(half), {3, 3, 3});
}

TEST(Embedding, TwoComponents) {
  EXPECT_TRUE(certificate_of(joined(cube(1), cube(1, {3, 0, 0}))).is_embedded());
  const MeshCertificate overlap = certificate_of(joined(cube(1), cube(1, {1.5, .1, .2})));
  EXPECT_GT(overlap.boundary.n_self_intersections, 0u);
  const MeshCertificate touching = certificate_of(joined(cube(1), cube(1, {2, 0, 0})));  // in a face
  EXPECT_GT(touching.boundary.n_self_intersections, 0u);
  const MeshCertificate within = certificate_of(joined(cube(1), cube(.3, {.1, .2, 0})));  // no faces meet
  EXPECT_EQ(within.boundary.n_self_intersections, 0u);
  EXPECT_EQ(within.boundary.n_wrongly_nested, 1u);
  EXPECT_FALSE(within.is_embedded());
}

TEST(Embedding, ABodyInACavity) {
  TetMesh shell = testing::box_tets(Vec3::Constant(-1), Vec3::Constant(1), {6, 6, 6});
  std::erase_if(shell.C, [&](const Tet& t) {
    const Vec3 centre = .25 * (shell.V[t[0]] + shell.V[t[1]] + shell.V[t[2]] + shell.V[t[3]]);
    return centre.cwiseAbs().maxCoeff() < 2. / 3;
  });
  EXPECT_TRUE(certificate_of(shell).is_embedded());
  EXPECT_TRUE(certificate_of(joined(shell, cube(.5))).is_embedded());
  const MeshCertificate across = certificate_of(joined(shell, cube(.7)));  // from the cavity into the shell
  EXPECT_FALSE(across.is_embedded());
  EXPECT_EQ(certificate_of(joined(joined(shell, cube(.5)), cube(.4))).boundary.n_wrongly_nested, 1u);
}

}  // namespace
}  // namespace umtet
