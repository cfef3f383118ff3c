#include "mesh/fast/smoothing/tangential_relaxation.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cstring>

#include "mesh/core/tet_quality.h"
#include "mesh/fast/projection/backtracking_projection.h"
#include "tests/support/omega_h_shell.h"

namespace umtet {
namespace {

using testing::off_surface;
using testing::omega_h_shell;
using testing::worst_quality;
using Role = ActiveLayer::Role;

/// A lens: its rim bends too sharply for h.
const testing::AnalyticDomain& lens() {
  static const testing::AnalyticDomain domain = testing::ellipsoid({1, 1, .15});
  return domain;
}

/// Projected and smoothed.
const ActiveLayer& lens_layer() {
  static const ActiveLayer made = [] {
    ActiveLayer layer = omega_h_shell(lens(), 20000);
    PNormSmoother smoother(layer);
    EXPECT_TRUE(project(smoother, lens()).not_arrived.empty());
    smoother.enqueue_all();
    smoother.run(lens(), {});
    return layer;
  }();
  return made;
}

ActiveLayer slid(const TangentialRelaxationParams& params) {
  ActiveLayer layer = lens_layer();
  PNormSmoother smoother(layer);
  std::vector<std::uint8_t> inside;
  for (const Role role : layer.role) inside.push_back(role != Role::Boundary);
  EXPECT_GT(relax_tangentially(smoother, inside, lens(), params, {}).moves, 0u);
  return layer;
}

/// Distances to psi = 0 of the middles of faces and their edges, ascending, in h.
std::vector<double> chords(const ActiveLayer& layer) {
  std::vector<double> list;
  for (const Tet& t : layer.C) {
    std::vector<Vec3> face;
    for (const int v : t) {
      if (layer.role[v] == Role::Boundary) face.push_back(layer.V[v]);
    }
    if (face.size() != 3) continue;
    const Vec3 &a = face[0], &b = face[1], &c = face[2];
    for (const Vec3& m : {Vec3((a + b + c) / 3), Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2)}) {
      list.push_back(off_surface(lens(), m) / layer.h);
    }
  }
  std::sort(list.begin(), list.end());
  return list;
}

TEST(TangentialRelaxation, BringsFacesNearerToRidgesAtNoCostInQuality) {
  const ActiveLayer& before = lens_layer();
  const ActiveLayer after = slid({});
  const std::vector<double> was = chords(before), is = chords(after);
  const auto at_99 = [](const std::vector<double>& v) { return v[v.size() * 99 / 100]; };
  EXPECT_LT(at_99(is), .92 * at_99(was)) << at_99(was) << " h";
  EXPECT_GE(worst_quality(after), std::min(.82, worst_quality(before)) - 1e-12);
  EXPECT_EQ(after.role, before.role);
  for (std::size_t v = 0; v < after.V.size(); ++v) {
    if (after.role[v] != Role::Boundary) continue;
    EXPECT_LE(off_surface(lens(), after.V[v]), 1e-10 * after.h);
  }
}

// Where no face is far, slides stop at a higher quality: fewer of them, and fewer tets just above the least.
TEST(TangentialRelaxation, KeepsMoreQualityWhereFacesAreNear) {
  const auto n_below = [](const ActiveLayer& layer, double Q) {
    std::size_t n = 0;
    for (const Tet& t : layer.C) n += mean_ratio(layer.V[t[0]], layer.V[t[1]], layer.V[t[2]], layer.V[t[3]]) < Q;
    return n;
  };
  const ActiveLayer one_bar = slid({.near_margin = 0}), two_bars = slid({});
  EXPECT_LT(n_below(two_bars, .84), n_below(one_bar, .84));
}

TEST(TangentialRelaxation, TheSameBytesForAnyNumberOfThreads) {
  const ActiveLayer many = slid({});
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const ActiveLayer one = slid({});
  EXPECT_EQ(std::memcmp(one.V.data(), many.V.data(), one.V.size() * sizeof(Vec3)), 0);
}

TEST(TangentialRelaxation, NamesEveryBrokenConstraint) {
  EXPECT_TRUE(problems(TangentialRelaxationParams{}).empty());
  const TangentialRelaxationParams wrong{
      .least_chord = 0, .least_quality = 1, .near_margin = -1, .far_chord = -1, .sweeps = -1, .inner_sweeps = -1};
  EXPECT_EQ(problems(wrong).size(), 6u);
}

}  // namespace
}  // namespace umtet
