#include "reconstruct/triangles/face_sides.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruct/triangles/face_patches.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

using test::cube;
using test::inside_out;
using test::moved;
using test::together;
using test::torus;

TEST(FacePatches, AClosedSurfaceIsOnePatchWithoutOpenEdges) {
  for (const TriangleMesh& mesh : {cube(), torus(), test::split(torus(), 0)}) {
    const FacePatches found = find_patches(mesh);
    EXPECT_EQ(found.size(), 1U);
    EXPECT_TRUE(found.is_closed[0]);
    EXPECT_EQ(found.n_open_edges + found.n_branching_edges + found.n_one_sided_edges, 0U);
    EXPECT_EQ(found.weld_distance, 0);
    EXPECT_EQ(std::count(found.is_turned.begin(), found.is_turned.end(), 1), 0);
  }
}

TEST(FacePatches, CornersThatWereMovedApartAreWelded) {
  const TriangleMesh soup = test::split(torus(), 1e-4 * diagonal_of(torus()));
  const FacePatches found = find_patches(soup);
  EXPECT_EQ(found.size(), 1U);
  EXPECT_EQ(found.n_open_edges, 0U);
  EXPECT_GT(found.weld_distance, 0);
  // Gaps are no reason to weld.
  EXPECT_EQ(find_patches(test::some_removed(torus(), .05)).weld_distance, 0);
}

TEST(FacePatches, AMoebiusStripHasNoSides) {
  TriangleMesh strip;
  const int n = 20;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n;
    for (const double t : {-.2, .2}) {
      const double r = 1 + t * std::cos(u / 2);
      strip.V.emplace_back(r * std::cos(u), r * std::sin(u), t * std::sin(u / 2));
    }
  }
  for (int i = 0; i < n; ++i) {
    const bool last = i == n - 1;
    const int a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    strip.F.push_back({a, c, b});
    strip.F.push_back({b, c, d});
  }
  EXPECT_EQ(find_patches(strip).n_one_sided_edges, 1U);
}

TEST(FacePatches, TrianglesThatAreThereTwiceOrHaveNoAreaGo) {
  TriangleMesh mesh = cube();
  mesh.F.push_back({mesh.F[3][1], mesh.F[3][0], mesh.F[3][2]});  // the same corners, turned
  mesh.F.push_back({0, 0, 1});
  mesh.V.push_back(mesh.V[5]);
  mesh.F.push_back({5, 8, 2});  // corners at one place
  mesh.labels.assign(mesh.F.size(), 7);
  const DroppedFaces dropped = drop_useless_faces(mesh);
  EXPECT_EQ(dropped.n_duplicates, 1U);
  EXPECT_EQ(dropped.n_degenerate, 2U);
  EXPECT_EQ(mesh.F, cube().F);
  EXPECT_EQ(mesh.labels.size(), 12U);
}

TEST(FaceSides, WhatLooksOutwardIsLeftAlone) {
  const TriangleMesh in_cavity = together(moved(cube(), Vec3::Constant(-1), 3), inside_out(cube()));
  for (const TriangleMesh& right : {cube(), torus(), test::split(torus(), 0), in_cavity}) {
    TriangleMesh mesh = right;
    EXPECT_EQ(orient_outward(mesh).n_turned, 0U);
    EXPECT_EQ(mesh.F, right.F);
  }
}

TEST(FaceSides, TurnedTrianglesAreTurnedBack) {
  for (const TriangleMesh& right : {torus(), test::split(torus(), 1e-4 * diagonal_of(torus()))}) {
    TriangleMesh mesh = test::some_turned(right, .1);
    ASSERT_NE(mesh.F, right.F);
    orient_outward(mesh);
    EXPECT_EQ(mesh.F, right.F);
    TriangleMesh all = inside_out(right);
    EXPECT_EQ(orient_outward(all).n_turned, right.F.size());
    // Corners come in another order.
    for (std::size_t f = 0; f < right.F.size(); ++f) EXPECT_GT(all.area_vector(f).dot(right.area_vector(f)), 0);
  }
}

TEST(FaceSides, TrianglesThatShareNothingFollowTheFieldOfTheOthers) {
  // So far apart that no tolerance welds them.
  TriangleMesh right = test::split(torus(), 0);
  for (std::size_t f = 0; f < right.F.size(); ++f) {
    const Vec3 c = right.centroid(f);
    for (const int v : right.F[f]) right.V[v] = c + .9 * (right.V[v] - c);
  }
  TriangleMesh mesh = test::some_turned(right, .1);
  const FaceSidesReport report = orient_outward(mesh);
  EXPECT_EQ(report.n_closed_patches, 0U);
  EXPECT_EQ(report.n_patches, right.F.size());
  EXPECT_EQ(mesh.F, right.F);
}

TEST(FaceSides, APatchThatEndsInTJunctionsFollowsTheOthers) {
  // The top is a fan around its middle, with corners amid its edges that its neighbours do not have.
  TriangleMesh right = cube();
  std::erase_if(right.F,
                [&](const Triangle& f) { return right.V[f[0]].z() + right.V[f[1]].z() + right.V[f[2]].z() == 3; });
  ASSERT_EQ(right.F.size(), 10U);
  const auto n = static_cast<int>(right.V.size());
  right.V.emplace_back(.5, .5, 1);
  for (const auto& [x, y] : std::initializer_list<std::pair<double, double>>{
           {0, 0}, {.5, 0}, {1, 0}, {1, .5}, {1, 1}, {.5, 1}, {0, 1}, {0, .5}})
    right.V.emplace_back(x, y, 1);
  for (int k = 0; k < 8; ++k) right.F.push_back({n, n + 1 + k, n + 1 + (k + 1) % 8});
  TriangleMesh mesh = right;
  for (std::size_t f = 10; f < 18; ++f) turn_face(mesh, f);
  const FaceSidesReport report = orient_outward(mesh);
  EXPECT_EQ(report.n_patches, 2U);
  EXPECT_EQ(report.n_open_edges, 4U + 8U);
  EXPECT_EQ(report.n_turned, 8U);
  for (std::size_t f = 0; f < 18; ++f) EXPECT_GT(mesh.area_vector(f).dot(right.area_vector(f)), 0) << f;
}

TEST(FaceSides, ShellsInsideOfOthersAreCavitiesOrSolidAsTheyLook) {
  const TriangleMesh shell = moved(cube(), Vec3::Constant(-1), 3);
  TriangleMesh cavity = together(shell, inside_out(cube())), solid = together(shell, cube());
  EXPECT_EQ(orient_outward(cavity).n_cavities, 1U);
  EXPECT_EQ(orient_outward(solid).n_inner_shells, 1U);
  // All of it inside-out is the same body.
  TriangleMesh turned = inside_out(cavity);
  EXPECT_EQ(orient_outward(turned).n_turned, turned.F.size());
  // Beside each other there is no cavity.
  TriangleMesh beside = together(cube(), inside_out(moved(cube(), {3, 0, 0}, .5)));
  const FaceSidesReport report = orient_outward(beside);
  EXPECT_EQ(report.n_cavities, 0U);
  EXPECT_EQ(report.n_turned, 12U);
}

TEST(FaceSides, AnOpenSurfaceThatLooksInwardIsTurned) {
  TriangleMesh bowl = torus();
  bowl.F.resize(bowl.F.size() * 3 / 4);
  TriangleMesh mesh = inside_out(bowl);
  EXPECT_EQ(orient_outward(mesh).n_turned, bowl.F.size());
}

}  // namespace
}  // namespace umtet
