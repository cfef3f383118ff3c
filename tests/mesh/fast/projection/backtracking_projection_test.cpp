#include "mesh/fast/projection/backtracking_projection.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cstring>

#include "tests/support/omega_h_shell.h"

namespace umtet {
namespace {

using testing::off_surface;
using testing::omega_h_shell;
using testing::worst_quality;
using Role = ActiveLayer::Role;

/// So coarse that vertices are in each other's way.
constexpr double kCoarse = 1000;

bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

/// What the report says of arrivals is what is found on the surface.
void expect_true_arrivals(const ActiveLayer& layer, const testing::AnalyticDomain& domain,
                          const ProjectionReport& report) {
  std::size_t n = 0, next = 0;
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    if (layer.role[i] != Role::Boundary) continue;
    ++n;
    const bool listed = next < report.not_arrived.size() && report.not_arrived[next].vertex == static_cast<int>(i);
    next += listed;
    EXPECT_EQ(off_surface(domain, layer.V[i]) <= 1e-10 * layer.h, !listed) << domain.name << " vertex " << i;
  }
  EXPECT_EQ(report.boundary, n);
  EXPECT_EQ(next, report.not_arrived.size());
  EXPECT_NEAR(report.min_quality, worst_quality(layer), 1e-12) << domain.name;
}

TEST(BacktrackingProjection, EveryVertexArrivesAndNoTetInverts) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    ActiveLayer layer = omega_h_shell(domain, 20000);
    const std::vector<Role> roles = layer.role;
    const ProjectionReport report = project(layer, domain);
    EXPECT_TRUE(report.not_arrived.empty()) << domain.name << ": " << report.not_arrived.size();
    EXPECT_TRUE(layer.role == roles);
    expect_true_arrivals(layer, domain, report);
    EXPECT_GE(report.min_quality, .2) << domain.name;
  }
}

TEST(BacktrackingProjection, ThoseHeldBackArriveInFurtherRounds) {
  const testing::AnalyticDomain domain = testing::equation_9();
  ActiveLayer layer = omega_h_shell(domain, kCoarse);
  const ProjectionReport report = project(layer, domain);
  EXPECT_GT(report.stopped_short, 0u);
  EXPECT_GT(report.rounds, ProjectionParams().passes);
  EXPECT_TRUE(report.not_arrived.empty());
  expect_true_arrivals(layer, domain, report);
  EXPECT_GE(report.min_quality, .2);
}

TEST(BacktrackingProjection, ThoseThatDoNotArriveAreListed) {
  const testing::AnalyticDomain domain = testing::equation_9();
  ProjectionParams params;
  params.max_rounds = params.passes;
  ActiveLayer layer = omega_h_shell(domain, kCoarse);
  const ProjectionReport held = project(layer, domain, params);
  ASSERT_FALSE(held.not_arrived.empty());
  for (const NotArrived& one : held.not_arrived) EXPECT_EQ(one.reason, NotArrived::Reason::Guard);
  expect_true_arrivals(layer, domain, held);
  EXPECT_GE(held.min_quality, .2);

  params.closest_point.max_distance = .3;
  layer = omega_h_shell(domain, 20000);
  const ActiveLayer before = layer;
  const ProjectionReport lost = project(layer, domain, params);
  ASSERT_FALSE(lost.not_arrived.empty());
  ASSERT_LT(lost.not_arrived.size(), lost.boundary);
  expect_true_arrivals(layer, domain, lost);
  std::size_t far = 0;
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    if (layer.role[i] != Role::Boundary) continue;
    far += !closest_point(domain, before.V[i], layer.h, params.closest_point).converged;
  }
  for (const NotArrived& one : lost.not_arrived) EXPECT_EQ(one.reason, NotArrived::Reason::NoFoot);
  EXPECT_EQ(lost.not_arrived.size(), far);
}

TEST(BacktrackingProjection, GuardHoldsWhereOneShotInverts) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer one_shot = omega_h_shell(domain, 20000);
  for (std::size_t i = 0; i < one_shot.V.size(); ++i) {
    if (one_shot.role[i] != Role::Boundary) continue;
    one_shot.V[i] = closest_point(domain, one_shot.V[i], one_shot.h, {}).point;
  }
  EXPECT_LT(worst_quality(one_shot), 0);
  for (const double least : {.1, .2, .4}) {
    ProjectionParams params;
    params.passes = 1;
    params.least_quality = least;
    ActiveLayer layer = omega_h_shell(domain, 20000);
    const ProjectionReport report = project(layer, domain, params);
    EXPECT_GT(report.stopped_short, 0u) << "least " << least;
    EXPECT_TRUE(report.not_arrived.empty()) << "least " << least;
    EXPECT_GE(worst_quality(layer), least * (1 - 1e-12));
  }
}

TEST(BacktrackingProjection, FixedVerticesDoNotMoveABit) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer layer = omega_h_shell(domain, 5000);
  for (std::size_t i = 0; i < layer.V.size(); i += 3) layer.role[i] = Role::Fixed;
  const ActiveLayer before = layer;
  project(layer, domain);
  EXPECT_TRUE(layer.role == before.role);
  EXPECT_FALSE(same_bytes(layer.V, before.V));
  for (std::size_t i = 0; i < layer.V.size(); i += 3) {
    ASSERT_EQ(std::memcmp(&layer.V[i], &before.V[i], sizeof(Vec3)), 0) << "vertex " << i;
  }
}

TEST(BacktrackingProjection, SameBytesForAnyNumberOfThreads) {
  const testing::AnalyticDomain domain = testing::equation_9();
  for (const double n_tets : {kCoarse, 20000.}) {
    std::vector<std::vector<Vec3>> results;
    for (const int threads : {1, 2, 3}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      ActiveLayer layer = omega_h_shell(domain, n_tets);
      project(layer, domain);
      results.push_back(layer.V);
    }
    EXPECT_TRUE(same_bytes(results[0], results[1]));
    EXPECT_TRUE(same_bytes(results[0], results[2]));
  }
}

TEST(BacktrackingProjection, RolesComeBackWhenItIsCancelled) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const testing::AnalyticDomain domain = testing::torus();
  for (const int after : {0, 3, 20}) {
    ActiveLayer layer = omega_h_shell(domain, 5000);
    const std::vector<Role> roles = layer.role;
    int asked = 0;
    EXPECT_THROW(project(layer, domain, {}, {.cancelled = [&] { return asked++ >= after; }}), Cancelled);
    EXPECT_TRUE(layer.role == roles);
  }
}

TEST(BacktrackingProjection, TheSmootherGoesOnWhereItEnded) {
  const testing::AnalyticDomain domain = testing::sphere();
  ActiveLayer layer = omega_h_shell(domain, 20000);
  PNormSmoother smoother(layer);
  project(smoother, domain);
  EXPECT_LT(worst_quality(layer), .7);
  smoother.run(domain, {});
  EXPECT_GT(worst_quality(layer), .78);
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    if (layer.role[i] != Role::Boundary) continue;
    ASSERT_LE(off_surface(domain, layer.V[i]), 1e-10 * layer.h);
  }
}

TEST(BacktrackingProjection, BadParametersAreAllNamed) {
  ProjectionParams params;
  params.passes = 0;
  params.max_rounds = -1;
  params.least_quality = 0;
  params.sweeps = -1;
  params.smoothing.target = 2;
  params.closest_point.tol = -1;
  EXPECT_EQ(problems(params).size(), 6u);
  ActiveLayer layer = omega_h_shell(testing::sphere(), 2000);
  EXPECT_THROW(project(layer, testing::sphere(), params), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
