#include "mesh/regions/periodic_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "mesh/core/tet_quality.h"
#include "mesh/regions/region_certificate.h"
#include "tests/support/regions.h"

namespace umtet {
namespace {

constexpr double kPi = std::numbers::pi;
const Box kUnit(Vec3::Zero(), Vec3::Ones());

/// sin x cos y + sin y cos z + sin z cos x + level, with one period in a box of these sides.
PatchFunction gyroid(const Vec3& sides, double level) {
  return [k = Vec3(2 * kPi / sides.array()), level](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    const Vec3 s = k.cwiseProduct(x).array().sin(), c = k.cwiseProduct(x).array().cos();
    if (gradient)
      for (int a = 0; a < 3; ++a) (*gradient)[a] = k[a] * (c[a] * c[(a + 1) % 3] - s[a] * s[(a + 2) % 3]);
    if (hessian)
      for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3;
        (*hessian)(a, a) = -k[a] * k[a] * (s[a] * c[b] + s[(a + 2) % 3] * c[a]);
        (*hessian)(a, b) = (*hessian)(b, a) = -k[a] * k[b] * c[a] * s[b];
      }
    return s[0] * c[1] + s[1] * c[2] + s[2] * c[0] + level;
  };
}

double volume_of(const TetMesh& mesh) {
  double six = 0;
  for (const Tet& t : mesh.C) six += volume6(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]);
  return six / 6;
}

void expect_exact_pairs(const PeriodicMesh& made) {
  EXPECT_FALSE(made.pairs.empty());
  for (const PeriodicPair& p : made.pairs)
    for (int a = 0; a < 3; ++a)
      EXPECT_EQ(made.mesh.mesh.V[p.copy][a], made.mesh.mesh.V[p.vertex][a] + p.periods[a] * made.sides[a]);
}

TEST(PeriodicMesh, SidesOfAGyroidMatchAndTetsAreAsGoodAsInTheMiddle) {
  const RegionDomain domain = RegionDomain::of_bodies({gyroid(Vec3::Ones(), 0)});
  for (const double h : {.09, .05}) {
    const PeriodicMesh made = make_periodic_region_mesh(domain, kUnit, h);
    ASSERT_EQ(made.mesh.status, UmStatus::Success);
    EXPECT_TRUE(made.mesh.defects.empty());
    const PeriodicMatch match = match_sides(made);
    EXPECT_EQ(match.farthest, 0);
    EXPECT_EQ(match.n_unmatched, 0U);
    EXPECT_EQ(match.n_pairs, made.pairs.size());
    expect_exact_pairs(made);
    EXPECT_NEAR(volume_of(made.mesh.mesh), 1, 1e-11);
    const RegionCertificate c = certify_regions(made.mesh.mesh, made.mesh.region, &domain, h, {}, match.sides);
    EXPECT_TRUE(failures(c, 2).empty()) << failures(c, 2)[0];
    EXPECT_GE(c.whole.quality.min, .77);
    // The two sides of a gyroid are congruent.
    EXPECT_NEAR(c.regions[0].certificate.volume, .5, .003);
  }
}

TEST(PeriodicMesh, ABodyAloneHasSidesAndASurface) {
  const RegionDomain domain = RegionDomain::of_bodies({gyroid(Vec3::Ones(), -.3)});
  const PeriodicMesh made = make_periodic_region_mesh(domain, kUnit, .06, {.has_outside = false});
  const PeriodicMatch match = match_sides(made);
  EXPECT_EQ(match.farthest, 0);
  EXPECT_GT(match.n_unmatched, 1000U);
  EXPECT_FALSE(match.sides.empty());
  expect_exact_pairs(made);
  const RegionCertificate c = certify_regions(made.mesh.mesh, made.mesh.region, &domain, .06, {}, match.sides);
  EXPECT_TRUE(failures(c, 2).empty()) << failures(c, 2)[0];
  EXPECT_EQ(c.interfaces[0].n_faces, match.n_unmatched);
  // Without the list of the sides they would be surfaces of the body.
  EXPECT_FALSE(failures(certify_regions(made.mesh.mesh, made.mesh.region, &domain, .06), 2).empty());
}

TEST(PeriodicMesh, ABoxOfUnequalSidesStretchesTheLattice) {
  const Vec3 sides(1, 1.43, .87);
  const RegionDomain domain = RegionDomain::of_bodies({gyroid(sides, -.6), gyroid(sides, .6)});
  const Box box(Vec3(.2, -.3, 7), Vec3(.2, -.3, 7) + sides);
  const PeriodicMesh made = make_periodic_region_mesh(domain, box, .05);
  const PeriodicMatch match = match_sides(made);
  EXPECT_EQ(match.n_unmatched, 0U);
  EXPECT_NEAR(volume_of(made.mesh.mesh), sides.prod(), 1e-11);
  const RegionCertificate c = certify_regions(made.mesh.mesh, made.mesh.region, &domain, .05, {}, match.sides);
  EXPECT_TRUE(failures(c, 3).empty()) << failures(c, 3)[0];
  EXPECT_GE(c.whole.quality.min, .7);
}

TEST(PeriodicMesh, AFoamHasCurvesThatCrossTheSides) {
  const auto cell_around = [](const Vec3& c) {
    return [c](const Vec3& x, Vec3* gradient, Mat3* hessian) {
      const double k = 2 * kPi;
      const Vec3 sine = (k * (x - c)).array().sin(), cosine = (k * (x - c)).array().cos();
      if (gradient) *gradient = k * sine;
      if (hessian) *hessian = (k * k * cosine).asDiagonal();
      return -cosine.sum();
    };
  };
  const RegionDomain domain =
      RegionDomain::of_least({cell_around({0, 0, 0}), cell_around({.5, .4, .1}), cell_around({.1, .55, .5})});
  const PeriodicMesh made = make_periodic_region_mesh(domain, kUnit, .07);
  EXPECT_EQ(match_sides(made).n_unmatched, 0U);
  EXPECT_TRUE(
      std::any_of(made.mesh.regions_at.begin(), made.mesh.regions_at.end(), [](RegionSet s) { return s == 7; }));
  EXPECT_NEAR(volume_of(made.mesh.mesh), 1, 1e-11);
  const PeriodicMatch match = match_sides(made);
  const RegionCertificate c = certify_regions(made.mesh.mesh, made.mesh.region, &domain, .07, {}, match.sides);
  EXPECT_TRUE(failures(c, 3).empty()) << failures(c, 3)[0];
  EXPECT_GE(c.whole.quality.min, .6);
}

TEST(PeriodicMesh, BytesAreTheSameForAnyNumberOfThreads) {
  const RegionDomain domain = RegionDomain::of_bodies({gyroid(Vec3::Ones(), -.6), gyroid(Vec3::Ones(), .6)});
  const auto made_by = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return make_periodic_region_mesh(domain, kUnit, .08);
  };
  const PeriodicMesh one = made_by(1), two = made_by(2);
  EXPECT_EQ(one.mesh.mesh.V, two.mesh.mesh.V);
  EXPECT_EQ(one.mesh.mesh.C, two.mesh.mesh.C);
  EXPECT_EQ(one.mesh.region, two.mesh.region);
}

TEST(PeriodicMesh, WhatDoesNotRepeatIsRefused) {
  const RegionDomain ball = RegionDomain::of_bodies({testing::ball({.5, .5, .5}, .3)});
  EXPECT_THROW(make_periodic_region_mesh(ball, kUnit, .05), std::invalid_argument);
  const RegionDomain domain = RegionDomain::of_bodies({gyroid(Vec3::Ones(), 0)});
  EXPECT_THROW(make_periodic_region_mesh(domain, kUnit, .3), std::invalid_argument);
  EXPECT_THROW(make_periodic_region_mesh(domain, Box(), .05), std::invalid_argument);
  EXPECT_THROW(make_periodic_region_mesh(domain, kUnit, 0), std::invalid_argument);
  const RegionDomain none = RegionDomain::of_bodies({gyroid(Vec3::Ones(), 9)});
  EXPECT_EQ(make_periodic_region_mesh(none, kUnit, .05).mesh.status, UmStatus::EmptyDomain);
}

TEST(PeriodicMatch, AMovedVertexIsFound) {
  PeriodicMesh made = make_periodic_region_mesh(RegionDomain::of_bodies({gyroid(Vec3::Ones(), 0)}), kUnit, .09);
  made.mesh.mesh.V[made.pairs[3].copy][1] += .25;
  EXPECT_NEAR(match_sides(made).farthest, .25, 1e-12);
  made.pairs.erase(made.pairs.begin() + 3);
  EXPECT_GT(match_sides(made).n_unmatched, 0U);
}

}  // namespace
}  // namespace umtet
