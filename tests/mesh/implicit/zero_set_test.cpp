#include "mesh/implicit/zero_set.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "common/polled_loops.h"
#include "tests/support/values.h"

namespace umtet {
namespace {

using testing::Values;

/// The signed distance to a ring, with its number of values.
struct Counted {
  std::atomic<int>* n;
  static double distance(const Vec3& x) { return std::hypot(std::hypot(x.x(), x.y()) - 1, x.z()) - .4; }
  double value(const Vec3& x) const {
    ++*n;
    return distance(x);
  }
  Vec3 gradient(const Vec3&) const { return Vec3::Zero(); }
};

using Box3 = Eigen::AlignedBox3d;

Box3 cube(double half) { return {Vec3::Constant(-half), Vec3::Constant(half)}; }

double chebyshev(int n, double x) {
  double before = 1, now = x;
  for (int i = 1; i < n; ++i) before = std::exchange(now, 2 * x * now - before);
  return now;
}

const Values kTorus{[](const Vec3& x) {
  const double q = std::hypot(x.x(), x.y()) - 1;
  return q * q + x.z() * x.z() - 0.16;
}};

TEST(ZeroSet, WhatIsKnownToBeFarFromAZeroNeedsNoValue) {
  // A distance function: |psi| > sqrt(3) spacing leaves no zero in the box around x.
  std::atomic<int> n_values = 0;
  const Counted ring{&n_values};
  const Eigen::AlignedBox3d box(Vec3(-2, -2, -1), Vec3(2, 2, 1));
  constexpr double kSpacing = .05;
  const ZeroSetTopology all = zero_set_topology(ring, box, kSpacing);
  const int n_nodes = n_values.exchange(0);
  const ZeroSetTopology some = zero_set_topology(
      ring, box, kSpacing, {}, [](const Vec3& x) { return std::abs(Counted::distance(x)) > 1.7321 * kSpacing; });
  EXPECT_LT(n_values, n_nodes / 4);
  EXPECT_EQ(some.euler_characteristic, all.euler_characteristic);
  EXPECT_EQ(some.cut_points, all.cut_points);
}

TEST(ZeroSet, SphereAndTorusHaveTheirTopologyAreaAndSeeds) {
  const Values sphere{[](const Vec3& x) { return x.squaredNorm() - 1; }};
  const ZeroSetTopology s = zero_set_topology(sphere, cube(1.3), 0.1);
  ASSERT_EQ(s.components.size(), 1u);
  EXPECT_EQ(s.euler_characteristic, 2);
  EXPECT_EQ(s.components[0].genus, 0);
  EXPECT_TRUE(s.components[0].closed);
  EXPECT_LE(s.spacing, 0.1);
  // The linear interpolant is off by up to spacing^2 |psi''| / 8 = .0025 in radius, so .5 % in area.
  EXPECT_NEAR(s.components[0].area, 4 * std::numbers::pi, 0.01 * 4 * std::numbers::pi);
  EXPECT_NEAR(s.components[0].seed.norm(), 1, 0.0026);
  EXPECT_TRUE(s.components[0].box.isApprox(cube(1), 0.01));

  const ZeroSetTopology t = zero_set_topology(kTorus, cube(1.5), 0.08);
  ASSERT_EQ(t.components.size(), 1u);
  EXPECT_EQ(t.components[0].euler_characteristic, 0);
  EXPECT_EQ(t.components[0].genus, 1);
}

TEST(ZeroSet, AreaErrorFallsAsTheSpacingSquared) {
  const double truth = 4 * std::numbers::pi * std::numbers::pi * 0.4;
  const double coarse = truth - zero_set_topology(kTorus, cube(1.5), 0.1).components[0].area;
  const double fine = truth - zero_set_topology(kTorus, cube(1.5), 0.05).components[0].area;
  EXPECT_NEAR(coarse / fine, 4, 0.5);
}

TEST(ZeroSet, BanchoffChmutovSurfacesHaveTheirGenus) {
  // T_n(x) + T_n(y) + T_n(z) = 0: genus 5 for n = 4 and 28 for n = 6.
  for (const auto& [n, genus, spacing] : {std::tuple{4, 5L, 0.06}, {6, 28L, 0.04}}) {
    const Values psi{[n = n](const Vec3& x) { return chebyshev(n, x[0]) + chebyshev(n, x[1]) + chebyshev(n, x[2]); }};
    const ZeroSetTopology z = zero_set_topology(psi, cube(1.3), spacing);
    ASSERT_EQ(z.components.size(), 1u) << n;
    EXPECT_EQ(z.components[0].genus, genus) << n;
    EXPECT_TRUE(z.components[0].closed);
  }
}

TEST(ZeroSet, SeparatePiecesAndShellsAreToldApart) {
  const Values balls{
      [](const Vec3& x) { return std::min((x - Vec3(0.6, 0, 0)).norm() - 0.5, (x + Vec3(0.6, 0, 0)).norm() - 0.3); }};
  const ZeroSetTopology two = zero_set_topology(balls, cube(1.3), 0.07);
  ASSERT_EQ(two.components.size(), 2u);
  EXPECT_EQ(two.euler_characteristic, 4);
  EXPECT_GT(two.components[0].area, two.components[1].area);
  EXPECT_GT(two.components[0].seed.x(), 0);
  EXPECT_LT(two.components[1].seed.x(), 0);
  std::size_t n_points = 0;
  for (const ZeroSetComponent& c : two.components) {
    for (const Vec3& x : two.points_of(c)) EXPECT_GT(x.x() * c.seed.x(), 0) << "a point of the other ball";
    n_points += two.points_of(c).size();
  }
  EXPECT_EQ(n_points, two.cut_points.size());

  const Values shell{[](const Vec3& x) { return std::abs(x.norm() - 0.8) - 0.2; }};
  const ZeroSetTopology walls = zero_set_topology(shell, cube(1.3), 0.07);
  EXPECT_EQ(walls.components.size(), 2u);
}

TEST(ZeroSet, ADomainThatLeavesTheBoxIsReported) {
  const ZeroSetTopology cut = zero_set_topology(kTorus, Box3(Vec3(-1.2, -1.5, -1), Vec3(1.5, 1.5, 1)), 0.1);
  ASSERT_EQ(cut.components.size(), 1u);
  EXPECT_FALSE(cut.components[0].closed);
  // A torus without a disk on one side of it: chi drops by one.
  EXPECT_EQ(cut.components[0].euler_characteristic, -1);

  const ZeroSetTopology filled = zero_set_topology(Values{[](const Vec3&) { return -1.0; }}, cube(1), 0.5);
  EXPECT_EQ(filled.components.size(), 0u);
}

TEST(ZeroSet, ValuesThatAreNoNumbersCountAsOutside) {
  const Values psi{
      [](const Vec3& x) { return x.norm() < 0.3 ? std::numeric_limits<double>::quiet_NaN() : x.squaredNorm() - 1; }};
  const ZeroSetTopology z = zero_set_topology(psi, cube(1.3), 0.1);
  EXPECT_GT(z.n_not_finite, 0u);
  EXPECT_EQ(z.components.size(), 2u);
}

TEST(ZeroSet, DoesNotDependOnTheNumberOfThreads) {
  ZeroSetTopology result[2];
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    result[threads - 1] = zero_set_topology(kTorus, cube(1.5), 0.06);
  }
  EXPECT_EQ(std::memcmp(&result[0].components[0].area, &result[1].components[0].area, sizeof(double)), 0);
  EXPECT_EQ(result[0].components[0].seed, result[1].components[0].seed);
  EXPECT_EQ(result[0].components[0].n_cut_edges, result[1].components[0].n_cut_edges);
}

TEST(ZeroSet, AsksEveryFewThousandNodesWhetherToGoOn) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  std::size_t calls = 0;
  const Box3 flat(Vec3(-1.5, -1.5, -0.03), Vec3(1.5, 1.5, 0.03));  // few layers of many nodes
  const ZeroSetTopology z = zero_set_topology(kTorus, flat, 0.01, {.cancelled = [&] { return ++calls == 0; }});
  const Vec3 n = (flat.sizes() / z.spacing).array().round() + 1;
  EXPECT_GE(static_cast<double>(calls), 4 * n.prod() / kValuesPerPoll);  // four passes over a layer
  for (const std::size_t stop : {std::size_t{1}, calls / 2, calls}) {
    std::size_t n = 0;
    EXPECT_THROW(zero_set_topology(kTorus, flat, 0.01, {.cancelled = [&] { return ++n >= stop; }}), Cancelled) << stop;
    EXPECT_EQ(n, stop);
  }
}

TEST(ZeroSet, RefusesBoxesAndSpacingsWithoutAGrid) {
  EXPECT_THROW(zero_set_topology(kTorus, Box3(), 0.1), std::invalid_argument);
  EXPECT_THROW(zero_set_topology(kTorus, cube(1), 0), std::invalid_argument);
  EXPECT_THROW(zero_set_topology(kTorus, cube(1), 1e-12), std::length_error);
}

}  // namespace
}  // namespace umtet
