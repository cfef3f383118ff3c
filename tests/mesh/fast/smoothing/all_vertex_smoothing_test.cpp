#include "mesh/fast/smoothing/all_vertex_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"
#include "tests/support/omega_h_shell.h"

namespace umtet {
namespace {

using testing::off_surface;
using testing::omega_h_shell;
using testing::worst_quality;
using Role = ActiveLayer::Role;

constexpr double kNoGoal = 1;

/// On psi = 0, and smoothed one vertex at a time until nothing moves.
ActiveLayer settled(const testing::AnalyticDomain& domain, double n_tets) {
  ActiveLayer layer = omega_h_shell(domain, n_tets);
  project(layer, domain);
  smooth(layer, domain, {.target = .99, .fine_gain = 1e-5, .least_step = 0, .least_gain = 1e-5});
  return layer;
}

TEST(AllVertexSmoothing, RaisesWhatOneVertexAtATimeCannot) {
  for (const testing::AnalyticDomain& domain : {testing::torus(), testing::sphere(), testing::equation_9()}) {
    SCOPED_TRACE(domain.name);
    ActiveLayer layer = settled(domain, 2000);
    const double before = worst_quality(layer);
    const AllVertexReport report = smooth_all_vertices(layer, domain, kNoGoal);
    EXPECT_GT(report.least, before + .005);
    EXPECT_NEAR(report.least, worst_quality(layer), 1e-12);
    for (std::size_t v = 0; v < layer.V.size(); ++v) {
      if (layer.role[v] != Role::Boundary) continue;
      EXPECT_LT(off_surface(domain, layer.V[v]), 1e-8 * layer.h);
    }
  }
}

/// The eight tets of a regular octahedron around a vertex that is not yet at its centre.
ActiveLayer octahedron() {
  ActiveLayer layer;
  layer.V = {{.2, -.1, .15}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const int x : {1, 2}) {
    for (const int y : {3, 4}) {
      for (const int z : {5, 6}) {
        const bool is_odd = (x == 2) != ((y == 4) != (z == 6));
        layer.C.push_back(is_odd ? Tet{0, x, z, y} : Tet{0, x, y, z});
      }
    }
  }
  layer.role.assign(7, Role::Fixed);
  layer.role[0] = Role::Inner;
  layer.h = 1;
  testing::complete(layer);
  return layer;
}

TEST(AllVertexSmoothing, OneVertexComesToTheMaxMinOfItsRing) {
  // At the centre the eight tets are alike: no other place is as good.
  ActiveLayer layer = octahedron();
  smooth_all_vertices(layer, testing::sphere(), kNoGoal);
  EXPECT_LT(layer.V[0].norm(), .005);
}

TEST(AllVertexSmoothing, EndsWhereTheNeededQualityIsOutOfReach) {
  ActiveLayer free = octahedron(), low = free, high = free;
  const AllVertexReport all = smooth_all_vertices(free, testing::sphere(), kNoGoal);
  // Of tets that are alike, the bound of every p is what is reached.
  EXPECT_EQ(smooth_all_vertices(low, testing::sphere(), kNoGoal, .99 * all.least).evaluations, all.evaluations);
  EXPECT_EQ(low.V, free.V);
  const AllVertexReport some = smooth_all_vertices(high, testing::sphere(), kNoGoal, 1.01 * all.least);
  EXPECT_LT(some.evaluations, all.evaluations);
  EXPECT_NEAR(some.least, all.least, .01);
}

TEST(AllVertexSmoothing, FixedVerticesStay) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer layer = settled(domain, 2000);
  for (std::size_t v = 0; v < layer.V.size(); ++v) {
    if (layer.V[v].x() > 0) layer.role[v] = Role::Fixed;
  }
  const std::vector<Vec3> before = layer.V;
  smooth_all_vertices(layer, domain, kNoGoal);
  std::size_t n_moved = 0;
  for (std::size_t v = 0; v < layer.V.size(); ++v) {
    const bool has_moved = layer.V[v] != before[v];
    EXPECT_FALSE(has_moved && layer.role[v] == Role::Fixed);
    n_moved += has_moved;
  }
  EXPECT_GT(n_moved, 10u);
}

TEST(AllVertexSmoothing, EndsAtTheGoal) {
  const testing::AnalyticDomain domain = testing::torus();
  const ActiveLayer layer = settled(domain, 2000);
  ActiveLayer far = layer, near = layer;
  const AllVertexReport all = smooth_all_vertices(far, domain, kNoGoal);
  const double goal = .5 * (worst_quality(layer) + all.least);
  const AllVertexReport some = smooth_all_vertices(near, domain, goal);
  EXPECT_GE(some.least, goal);
  EXPECT_LT(some.evaluations, all.evaluations);
  EXPECT_LT(some.psi_evaluations, all.psi_evaluations);
}

TEST(AllVertexSmoothing, WhatIsTangledStaysAsItIs) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer layer = settled(domain, 2000);
  const Tet& t = layer.C.front();
  std::swap(layer.V[t[0]], layer.V[t[1]]);
  const std::vector<Vec3> before = layer.V;
  EXPECT_EQ(smooth_all_vertices(layer, domain, kNoGoal).least, 0);
  EXPECT_EQ(layer.V, before);
}

TEST(AllVertexSmoothing, NothingToMoveIsNoWork) {
  ActiveLayer layer = omega_h_shell(testing::sphere(), 500);
  layer.role.assign(layer.V.size(), Role::Fixed);
  EXPECT_EQ(smooth_all_vertices(layer, testing::sphere(), kNoGoal).evaluations, 0);
}

}  // namespace
}  // namespace umtet
