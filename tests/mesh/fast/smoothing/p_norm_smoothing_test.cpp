#include "mesh/fast/smoothing/p_norm_smoothing.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/fast/smoothing/ring_newton.h"
#include "tests/support/omega_h_shell.h"

namespace umtet {
namespace {

using testing::background_star;
using testing::off_surface;
using testing::omega_h_shell;
using testing::ring_quality;
using testing::worst_quality;
using Role = ActiveLayer::Role;

Vec3 random_vector(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return size * Vec3(unit(random), unit(random), unit(random));
}

/// Vertices on psi = 0 where they are Boundary, and away from where they belong along it and inside.
ActiveLayer disordered(const testing::AnalyticDomain& domain, double n_tets, double size) {
  ActiveLayer layer = omega_h_shell(domain, n_tets);
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    layer.V[i] += random_vector(random, size * layer.h);
    if (layer.role[i] == Role::Boundary) layer.V[i] = closest_point(domain, layer.V[i], layer.h, {}).point;
  }
  return layer;
}

std::size_t tangled_vertices(const ActiveLayer& layer) {
  std::set<int> tangled;
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    if (layer.role[i] != Role::Fixed && !(ring_quality(layer, static_cast<int>(i)) > 0)) tangled.insert(i);
  }
  return tangled.size();
}

bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST(PNormSmooth, DerivativesAreThoseOfTheSum) {
  std::mt19937_64 random(3);
  for (const int type : {0, 2}) {
    ActiveLayer layer = background_star(type);
    for (Vec3& x : layer.V) x += random_vector(random, .05);
    const OneRing ring = PNormSmoother(layer).ring(0);
    for (const int log2_p : {4, 5}) {
      const double p = 1 << log2_p, d = 1e-5;
      const Vec3 y = random_vector(random, .05);
      const detail::PowerSum at_y = detail::power_sum(ring, y, log2_p, 1.5);
      double sum = 0;
      ActiveLayer moved = layer;
      moved.V[0] += y;
      for (int t = 0; t < static_cast<int>(layer.C.size()); ++t) {
        sum += std::pow(std::pow(testing::tet_quality(moved, t), -3) / 1.5, p);
      }
      EXPECT_NEAR(at_y.sum / sum, 1, 1e-9);
      for (int k = 0; k < 3; ++k) {
        const detail::PowerSum right = detail::power_sum(ring, y + d * Vec3::Unit(k), log2_p, 1.5);
        const detail::PowerSum left = detail::power_sum(ring, y - d * Vec3::Unit(k), log2_p, 1.5);
        EXPECT_NEAR(std::log(right.sum / left.sum) / p / (2 * d), at_y.gradient[k], 1e-5) << "p = " << p;
        const Vec3 column = (right.gradient - left.gradient) / (2 * d);
        EXPECT_LT((column - at_y.hessian.col(k)).norm(), 1e-4 * at_y.hessian.norm()) << "p = " << p;
      }
    }
    EXPECT_THROW(detail::power_sum(ring, Vec3::Zero(), 3, 1), std::invalid_argument);
  }
}

TEST(PNormSmooth, SumIsInfiniteWhereATetIsNotPositive) {
  ActiveLayer layer = background_star(0);
  const OneRing ring = PNormSmoother(layer).ring(0);
  EXPECT_TRUE(std::isfinite(detail::power_sum(ring, Vec3::Zero(), 5, 1).sum));
  EXPECT_TRUE(std::isinf(detail::power_sum(ring, Vec3(1, 0, 0), 5, 1).sum));
}

TEST(PNormSmooth, DisplacedVertexOfTheBackgroundReturns) {
  std::mt19937_64 random(5);
  const testing::AnalyticDomain unused = testing::sphere();
  SmoothingParams params;
  params.target = .97;  // more than the star can have: it is visited until nothing is gained
  for (const int type : {0, 1, 2, 5}) {
    ActiveLayer layer = background_star(type);
    const Vec3 home = layer.V[0];
    const double best = worst_quality(layer);
    for (int trial = 0; trial < 20; ++trial) {
      layer.V[0] = home + random_vector(random, .25);
      const SmoothingReport report = smooth(layer, unused, params);
      EXPECT_TRUE(report.settled);
      EXPECT_LT((layer.V[0] - home).norm(), 2e-2) << "type " << type;
      EXPECT_GT(worst_quality(layer), best - 5e-3) << "type " << type;
    }
  }
}

TEST(PNormSmooth, TangledVertexIsUntangled) {
  std::mt19937_64 random(7);
  const testing::AnalyticDomain unused = testing::sphere();
  for (const int type : {0, 1, 2, 5}) {
    ActiveLayer layer = background_star(type);
    const Vec3 home = layer.V[0];
    int n = 0;
    for (int trial = 0; trial < 200; ++trial) {
      layer.V[0] = home + random_vector(random, 1.2);
      if (worst_quality(layer) > 0) continue;
      ++n;
      const SmoothingReport report = smooth(layer, unused);
      EXPECT_EQ(report.tangled, 0u);
      EXPECT_GE(worst_quality(layer), .82) << "type " << type << " from " << (layer.V[0] - home).transpose();
    }
    EXPECT_GT(n, 50);
  }
}

TEST(PNormSmooth, TangledBoundaryVertexIsUntangledOnTheSurface) {
  const testing::AnalyticDomain domain = testing::sphere();
  const ActiveLayer good = [&] {
    ActiveLayer layer = disordered(domain, 4000, 0);
    smooth(layer, domain);
    return layer;
  }();
  ASSERT_GT(worst_quality(good), .6);
  int n = 0;
  for (std::size_t i = 0; i < good.V.size() && n < 60; i += 7) {
    if (good.role[i] != Role::Boundary) continue;
    ActiveLayer layer = good;
    for (Role& role : layer.role) role = Role::Fixed;
    layer.role[i] = Role::Boundary;
    const Vec3 aside = 1.1 * layer.h * domain.gradient(layer.V[i]).unitOrthogonal();
    layer.V[i] = closest_point(domain, layer.V[i] + aside, layer.h, {}).point;
    if (ring_quality(layer, static_cast<int>(i)) > 0) continue;
    ++n;
    EXPECT_EQ(smooth(layer, domain).tangled, 0u) << "vertex " << i;
    EXPECT_GT(ring_quality(layer, static_cast<int>(i)), .5) << "vertex " << i;
    EXPECT_LE(off_surface(domain, layer.V[i]), 1e-10 * layer.h);
  }
  EXPECT_GT(n, 20);
}

TEST(PNormSmooth, FootThatInvertsTetsIsRefused) {
  struct Plane {
    double z;
    double value(const Vec3& x) const { return x.z() - z; }
    Vec3 gradient(const Vec3&) const { return Vec3::UnitZ(); }
  };
  std::mt19937_64 random(11);
  int n = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    ActiveLayer layer = background_star(trial % 8);
    layer.role[0] = Role::Boundary;
    layer.V[0] += random_vector(random, 1);
    // Nearly flat: an inverted ring behind the star may well have lower L^3 / V^2.
    if (!(worst_quality(layer) > 0 && worst_quality(layer) < .1)) continue;
    ++n;
    smooth(layer, Plane{layer.V[0].z() + random_vector(random, 1.5).z()});
    ASSERT_GT(worst_quality(layer), 0);
  }
  EXPECT_GT(n, 20);
}

TEST(PNormSmooth, VisitLosesNoMoreThanTheGuardSays) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer layer = disordered(domain, 3000, .12);
  for (int i = 0; i < static_cast<int>(layer.V.size()); ++i) {
    ActiveLayer one = layer;
    for (Role& role : one.role) role = Role::Fixed;
    one.role[i] = layer.role[i];
    const double before = ring_quality(one, i), n = one.ring_begin[i + 1] - one.ring_begin[i];
    SmoothingParams params;
    params.max_sweeps = 1;
    smooth(one, domain, params);
    if (before > 0) {
      ASSERT_GE(ring_quality(one, i), before * std::pow(n, -1. / 96)) << "vertex " << i;
    }
    layer.V[i] = one.V[i];
    if (i == 300) break;
  }
}

TEST(PNormSmooth, WorstTetRisesToThePlateauOnTheSurface) {
  for (const testing::AnalyticDomain& domain : {testing::sphere(), testing::torus(), testing::equation_9()}) {
    ActiveLayer layer = omega_h_shell(domain, 10000);
    EXPECT_TRUE(project(layer, domain).not_arrived.empty());
    EXPECT_LT(worst_quality(layer), .6) << domain.name;
    const SmoothingReport report = smooth(layer, domain);
    EXPECT_NEAR(report.min_quality, worst_quality(layer), 1e-12) << domain.name;
    EXPECT_GT(report.min_quality, .77) << domain.name;  // classified by sign; the paper's dvr ends at .73-.77
    EXPECT_TRUE(report.settled) << domain.name;
    EXPECT_GE(report.checks, report.solves);
    EXPECT_GE(report.solves, report.moves);
    EXPECT_GT(report.psi_evaluations, report.moves / 4);
    for (std::size_t i = 0; i < layer.V.size(); ++i) {
      if (layer.role[i] != Role::Boundary) continue;
      ASSERT_LE(off_surface(domain, layer.V[i]), 1e-10 * layer.h) << domain.name << " vertex " << i;
    }
  }
}

TEST(PNormSmooth, ManyTangledVerticesAreUntangled) {
  for (const testing::AnalyticDomain& domain : {testing::sphere(), testing::torus(), testing::equation_9()}) {
    ActiveLayer layer = disordered(domain, 10000, .1);
    EXPECT_GT(tangled_vertices(layer), 50u) << domain.name;
    EXPECT_EQ(smooth(layer, domain).tangled, 0u) << domain.name;
    EXPECT_EQ(tangled_vertices(layer), 0u) << domain.name;
  }
}

TEST(PNormSmooth, SettledMeansThatNobodyWasForgotten) {
  SmoothingParams params;
  params.margin = .02;  // the shares below were measured with these
  params.fine_gain = params.least_gain;
  params.least_step = 0;
  for (const testing::AnalyticDomain& domain : {testing::torus(), testing::equation_9()}) {
    ActiveLayer layer = omega_h_shell(domain, 20000);
    project(layer, domain);
    const SmoothingReport first = smooth(layer, domain, params), second = smooth(layer, domain, params);
    EXPECT_TRUE(first.settled);
    EXPECT_LT(second.moves, first.moves / 200)
        << domain.name;  // 1 in 360; 1 in 90 if only below target tets of before enqueue
  }
}

TEST(PNormSmooth, ShortMovesWakeNobodyUnlessARingIsBad) {
  const testing::AnalyticDomain domain = testing::torus();
  SmoothingParams params;
  params.least_step = 10;  // h: no move is as long
  for (const double target : {.3, .82}) {
    ActiveLayer layer = omega_h_shell(domain, 5000);
    project(layer, domain);
    std::mt19937_64 random(1);
    for (std::size_t i = 0; i < layer.V.size(); ++i) {
      if (layer.role[i] == Role::Inner) layer.V[i] += random_vector(random, .08 * layer.h);
    }
    ASSERT_GT(worst_quality(layer), .3);
    ASSERT_LT(worst_quality(layer), .82);
    params.target = target;
    params.margin = .86 - target;
    const SmoothingReport report = smooth(layer, domain, params);
    const auto movable = static_cast<std::size_t>(
        std::count_if(layer.role.begin(), layer.role.end(), [](Role role) { return role != Role::Fixed; }));
    EXPECT_GT(report.moves, 100u);
    if (target < .5) {
      EXPECT_EQ(report.checks, movable);
    } else {
      EXPECT_GT(report.checks, movable);
    }
  }
}

TEST(PNormSmooth, GoodRingsAndFixedVerticesDoNotMoveABit) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer layer = disordered(domain, 5000, .1);
  for (std::size_t i = 0; i < layer.V.size(); i += 3) layer.role[i] = Role::Fixed;
  const ActiveLayer before = layer;
  const SmoothingReport report = smooth(layer, domain);
  EXPECT_GT(report.moves, 100u);
  EXPECT_EQ(report.tangled, tangled_vertices(layer));
  for (std::size_t i = 0; i < layer.V.size(); i += 3) {
    ASSERT_EQ(std::memcmp(&layer.V[i], &before.V[i], sizeof(Vec3)), 0) << "vertex " << i;
  }
  ActiveLayer background = omega_h_shell(domain, 5000);
  const std::vector<Vec3> lattice = background.V;
  const SmoothingReport nothing = smooth(background, domain);
  EXPECT_EQ(nothing.solves, 0u);
  EXPECT_EQ(nothing.moves, 0u);
  EXPECT_TRUE(nothing.settled);
  EXPECT_TRUE(same_bytes(background.V, lattice));
}

TEST(PNormSmooth, ReportsWhatCannotBeUntangled) {
  ActiveLayer layer = background_star(0);
  for (std::size_t i = 1; i < layer.V.size(); ++i) layer.V[i].x() = -layer.V[i].x();  // a star inside out
  const SmoothingReport report = smooth(layer, testing::sphere());
  EXPECT_EQ(report.tangled, 1u);
  EXPECT_LE(report.min_quality, 0);
}

TEST(PNormSmooth, SameBytesForAnyNumberOfThreads) {
  const testing::AnalyticDomain domain = testing::torus();
  std::vector<std::vector<Vec3>> results;
  std::vector<SmoothingReport> reports;
  for (const int threads : {1, 2, 3}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    ActiveLayer layer = disordered(domain, 20000, .12);
    reports.push_back(smooth(layer, domain));
    results.push_back(layer.V);
  }
  for (int k = 1; k < 3; ++k) {
    EXPECT_TRUE(same_bytes(results[0], results[k]));
    EXPECT_EQ(reports[0].solves, reports[k].solves);
    EXPECT_EQ(reports[0].psi_evaluations, reports[k].psi_evaluations);
  }
}

TEST(PNormSmooth, HeldVerticesStayInTheQueue) {
  const testing::AnalyticDomain domain = testing::torus();
  ActiveLayer layer = disordered(domain, 3000, .1);
  const std::vector<Role> roles = layer.role;
  PNormSmoother smoother(layer);
  layer.role.assign(roles.size(), Role::Fixed);
  const std::vector<Vec3> before = layer.V;
  EXPECT_EQ(smoother.run(domain, {}).checks, 0u);
  EXPECT_TRUE(same_bytes(before, layer.V));
  layer.role = roles;
  smoother.run(domain, {});
  EXPECT_EQ(tangled_vertices(layer), 0u);
  EXPECT_GT(worst_quality(layer), .7);
}

TEST(PNormSmooth, BadParametersAndCancelling) {
  const testing::AnalyticDomain domain = testing::sphere();
  ActiveLayer layer = omega_h_shell(domain, 2000);
  SmoothingParams params;
  params.target = 1;
  params.margin = -1;
  params.least_gain = 0;
  params.fine_gain = 0;
  params.least_step = -1;
  params.max_sweeps = -1;
  params.closest_point.tol = 0;
  EXPECT_EQ(problems(params).size(), 7u);
  EXPECT_THROW(smooth(layer, domain, params), std::invalid_argument);
  EXPECT_THROW(smooth(layer, domain, {}, {.cancelled = [] { return true; }}), Cancelled);
}

}  // namespace
}  // namespace umtet
