#include "mesh/fast/backtracking_projection.h"

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
using Role = Shell::Role;

/// So coarse that vertices are in each other's way.
constexpr double kCoarse = 1000;

bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

/// What the report says of arrivals is what is found on the surface.
void expect_true_arrivals(const Shell& shell, const testing::AnalyticDomain& domain, const ProjectionReport& report) {
  std::size_t n = 0, next = 0;
  for (std::size_t i = 0; i < shell.V.size(); ++i) {
    if (shell.role[i] != Role::Boundary) continue;
    ++n;
    const bool listed = next < report.not_arrived.size() && report.not_arrived[next].vertex == static_cast<int>(i);
    next += listed;
    EXPECT_EQ(off_surface(domain, shell.V[i]) <= 1e-10 * shell.h, !listed) << domain.name << " vertex " << i;
  }
  EXPECT_EQ(report.boundary, n);
  EXPECT_EQ(next, report.not_arrived.size());
  EXPECT_NEAR(report.min_quality, worst_quality(shell), 1e-12) << domain.name;
}

TEST(GuardedProjection, EveryVertexArrivesAndNoTetInverts) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    Shell shell = omega_h_shell(domain, 20000);
    const std::vector<Role> roles = shell.role;
    const ProjectionReport report = project(shell, domain);
    EXPECT_TRUE(report.not_arrived.empty()) << domain.name << ": " << report.not_arrived.size();
    EXPECT_TRUE(shell.role == roles);
    expect_true_arrivals(shell, domain, report);
    EXPECT_GE(report.min_quality, .2) << domain.name;
  }
}

TEST(GuardedProjection, ThoseHeldBackArriveInFurtherRounds) {
  const testing::AnalyticDomain domain = testing::equation_9();
  Shell shell = omega_h_shell(domain, kCoarse);
  const ProjectionReport report = project(shell, domain);
  EXPECT_GT(report.stopped_short, 0u);
  EXPECT_GT(report.rounds, ProjectionParams().passes);
  EXPECT_TRUE(report.not_arrived.empty());
  expect_true_arrivals(shell, domain, report);
  EXPECT_GE(report.min_quality, .2);
}

TEST(GuardedProjection, ThoseThatDoNotArriveAreListed) {
  const testing::AnalyticDomain domain = testing::equation_9();
  ProjectionParams params;
  params.max_rounds = params.passes;
  Shell shell = omega_h_shell(domain, kCoarse);
  const ProjectionReport held = project(shell, domain, params);
  ASSERT_FALSE(held.not_arrived.empty());
  for (const NotArrived& one : held.not_arrived) EXPECT_EQ(one.reason, NotArrived::Reason::Guard);
  expect_true_arrivals(shell, domain, held);
  EXPECT_GE(held.min_quality, .2);

  params.closest_point.max_distance = .3;
  shell = omega_h_shell(domain, 20000);
  const Shell before = shell;
  const ProjectionReport lost = project(shell, domain, params);
  ASSERT_FALSE(lost.not_arrived.empty());
  ASSERT_LT(lost.not_arrived.size(), lost.boundary);
  expect_true_arrivals(shell, domain, lost);
  std::size_t far = 0;
  for (std::size_t i = 0; i < shell.V.size(); ++i) {
    if (shell.role[i] != Role::Boundary) continue;
    far += !closest_point(domain, before.V[i], shell.h, params.closest_point).converged;
  }
  for (const NotArrived& one : lost.not_arrived) EXPECT_EQ(one.reason, NotArrived::Reason::NoFoot);
  EXPECT_EQ(lost.not_arrived.size(), far);
}

TEST(GuardedProjection, GuardHoldsWhereOneShotInverts) {
  const testing::AnalyticDomain domain = testing::torus();
  Shell one_shot = omega_h_shell(domain, 20000);
  for (std::size_t i = 0; i < one_shot.V.size(); ++i) {
    if (one_shot.role[i] != Role::Boundary) continue;
    one_shot.V[i] = closest_point(domain, one_shot.V[i], one_shot.h, {}).point;
  }
  EXPECT_LT(worst_quality(one_shot), 0);
  for (const double least : {.1, .2, .4}) {
    ProjectionParams params;
    params.passes = 1;
    params.least_quality = least;
    Shell shell = omega_h_shell(domain, 20000);
    const ProjectionReport report = project(shell, domain, params);
    EXPECT_GT(report.stopped_short, 0u) << "least " << least;
    EXPECT_TRUE(report.not_arrived.empty()) << "least " << least;
    EXPECT_GE(worst_quality(shell), least * (1 - 1e-12));
  }
}

TEST(GuardedProjection, FixedVerticesDoNotMoveABit) {
  const testing::AnalyticDomain domain = testing::torus();
  Shell shell = omega_h_shell(domain, 5000);
  for (std::size_t i = 0; i < shell.V.size(); i += 3) shell.role[i] = Role::Fixed;
  const Shell before = shell;
  project(shell, domain);
  EXPECT_TRUE(shell.role == before.role);
  EXPECT_FALSE(same_bytes(shell.V, before.V));
  for (std::size_t i = 0; i < shell.V.size(); i += 3) {
    ASSERT_EQ(std::memcmp(&shell.V[i], &before.V[i], sizeof(Vec3)), 0) << "vertex " << i;
  }
}

TEST(GuardedProjection, SameBytesForAnyNumberOfThreads) {
  const testing::AnalyticDomain domain = testing::equation_9();
  for (const double n_tets : {kCoarse, 20000.}) {
    std::vector<std::vector<Vec3>> results;
    for (const int threads : {1, 2, 3}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      Shell shell = omega_h_shell(domain, n_tets);
      project(shell, domain);
      results.push_back(shell.V);
    }
    EXPECT_TRUE(same_bytes(results[0], results[1]));
    EXPECT_TRUE(same_bytes(results[0], results[2]));
  }
}

TEST(GuardedProjection, RolesComeBackWhenItIsCancelled) {
  const testing::AnalyticDomain domain = testing::torus();
  for (const int after : {0, 3, 20}) {
    Shell shell = omega_h_shell(domain, 5000);
    const std::vector<Role> roles = shell.role;
    int asked = 0;
    EXPECT_THROW(project(shell, domain, {}, [&] { return asked++ < after; }), MeshCancelled);
    EXPECT_TRUE(shell.role == roles);
  }
}

TEST(GuardedProjection, TheSmootherGoesOnWhereItEnded) {
  const testing::AnalyticDomain domain = testing::sphere();
  Shell shell = omega_h_shell(domain, 20000);
  PNormSmoother smoother(shell);
  project(smoother, domain);
  EXPECT_LT(worst_quality(shell), .7);
  smoother.run(domain, {});
  EXPECT_GT(worst_quality(shell), .78);
  for (std::size_t i = 0; i < shell.V.size(); ++i) {
    if (shell.role[i] != Role::Boundary) continue;
    ASSERT_LE(off_surface(domain, shell.V[i]), 1e-10 * shell.h);
  }
}

TEST(GuardedProjection, BadParametersAreAllNamed) {
  ProjectionParams params;
  params.passes = 0;
  params.max_rounds = -1;
  params.least_quality = 0;
  params.sweeps = -1;
  params.smoothing.target = 2;
  params.closest_point.tol = -1;
  EXPECT_EQ(problems(params).size(), 6u);
  Shell shell = omega_h_shell(testing::sphere(), 2000);
  EXPECT_THROW(project(shell, testing::sphere(), params), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
