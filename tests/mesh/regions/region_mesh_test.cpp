#include "mesh/regions/region_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "mesh/background/a15_box.h"
#include "mesh/core/tet_quality.h"
#include "mesh/regions/region_certificate.h"
#include "tests/support/regions.h"

namespace umtet {
namespace {

using testing::ball;
using testing::placed;

constexpr double kPi = std::numbers::pi;

BackgroundMesh lattice(double half, double h) {
  return BackgroundMesh(a15(), Box(Vec3::Constant(-half), Vec3::Constant(half)), h);
}

/// A random rotation, and a shift by up to one edge.
struct Position {
  Mat3 R;
  Vec3 shift;
};
std::vector<Position> positions(unsigned n, double h) {
  std::vector<Position> list;
  for (unsigned seed = 1; seed <= n; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-h, h);
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    q.normalize();
    list.push_back({q.toRotationMatrix(), Vec3(uniform(random), uniform(random), uniform(random))});
  }
  return list;
}

const RegionMeasures& measures_of(const RegionCertificate& c, int region) {
  return *std::find_if(c.regions.begin(), c.regions.end(), [&](const auto& m) { return m.region == region; });
}

double least_quality(const RegionMesh& made, int region) {
  double least = 1;
  for (std::size_t t = 0; t < made.mesh.C.size(); ++t)
    if (made.region[t] == region) least = std::min(least, mean_ratio(made.mesh, made.mesh.C[t]));
  return least;
}

TEST(RegionMesh, BothSidesOfASphereHaveGoodTets) {
  const BackgroundMesh background = lattice(1.6, .12);
  for (const Position& p : positions(5, .12)) {
    const RegionDomain domain = RegionDomain::of_bodies({placed(ball({0, 0, 0}, 1), p.R, p.shift)});
    const RegionMesh made = make_region_mesh(domain, background);
    ASSERT_EQ(made.status, UmStatus::Success);
    EXPECT_TRUE(made.defects.empty());
    EXPECT_GE(least_quality(made, 0), .77);
    EXPECT_GE(least_quality(made, 1), .77);
    const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
    EXPECT_TRUE(failures(c, 2).empty()) << failures(c, 2)[0];
    EXPECT_NEAR(measures_of(c, 1).certificate.volume, 4 * kPi / 3, .02 * 4 * kPi / 3);
    EXPECT_EQ(measures_of(c, 1).certificate.boundary.genus, 0);
    EXPECT_TRUE(c.whole.is_embedded());
  }
}

TEST(RegionMesh, BothSidesOfATorusHaveGoodTets) {
  const BackgroundMesh background = lattice(1.8, .1);
  for (const Position& p : positions(3, .1)) {
    const RegionDomain domain = RegionDomain::of_bodies({placed(testing::torus(1, .4), p.R, p.shift)});
    const RegionMesh made = make_region_mesh(domain, background);
    ASSERT_EQ(made.status, UmStatus::Success);
    EXPECT_GE(std::min(least_quality(made, 0), least_quality(made, 1)), .77);
    const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
    EXPECT_TRUE(failures(c, 2).empty()) << failures(c, 2)[0];
    EXPECT_EQ(measures_of(c, 1).certificate.boundary.genus, 1);
  }
}

TEST(RegionMesh, WallsOfABoxStayFlat) {
  const Box box(Vec3(-1.5, -1.6, -1.7), Vec3(1.5, 1.6, 1.7));
  const BackgroundMesh background(a15_box(box, .12));
  const RegionDomain domain = RegionDomain::of_bodies({ball({.1, 0, 0}, 1)});
  const RegionMesh made = make_region_mesh(domain, background);
  ASSERT_EQ(made.status, UmStatus::Success);
  const RegionCertificate c = certify_regions(made.mesh, made.region, &domain);
  EXPECT_TRUE(failures(c, 2).empty());
  EXPECT_NEAR(c.whole.volume, box.volume(), 1e-9);
  EXPECT_GE(c.whole.quality.min, .70);
  EXPECT_GE(measures_of(c, 0).min_quality_off_boundary, .77);
}

TEST(RegionMesh, NestedBodiesShareNoInterfaceButTheirOwn) {
  const BackgroundMesh background = lattice(1.6, .1);
  const RegionDomain domain = RegionDomain::of_bodies({ball({0, 0, 0}, 1.2), ball({.05, 0, 0}, .7)});
  const RegionMesh made = make_region_mesh(domain, background);
  const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
  EXPECT_TRUE(failures(c, 3).empty());
  ASSERT_EQ(c.interfaces.size(), 2U);
  EXPECT_EQ(c.interfaces[0].other, 0);
  EXPECT_EQ(c.interfaces[0].region, 1);
  EXPECT_EQ(c.interfaces[1].other, 1);
  EXPECT_EQ(c.interfaces[1].region, 2);
  EXPECT_GE(c.whole.quality.min, .77);
  EXPECT_NEAR(measures_of(c, 2).certificate.volume, 4 * kPi / 3 * .343, .02 * 4 * kPi / 3 * .343);
}

TEST(RegionMesh, OverlappingBodiesMeetInACurve) {
  const BackgroundMesh background = lattice(1.8, .1);
  const RegionDomain domain = RegionDomain::of_bodies({ball({-.5, 0, 0}, .8), ball({.5, .1, 0}, .8)});
  const RegionMesh made = make_region_mesh(domain, background);
  EXPECT_TRUE(std::any_of(made.regions_at.begin(), made.regions_at.end(), [](RegionSet s) { return s == 7; }));
  const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
  EXPECT_TRUE(failures(c, 3).empty()) << failures(c, 3)[0];
  EXPECT_EQ(c.interfaces.size(), 3U);
  EXPECT_GE(c.whole.quality.min, .7);
  EXPECT_EQ(measures_of(c, 1).n_pieces, 1);
}

TEST(RegionMesh, ADoubleBubbleHasItsCurveWhereAllThreeMeet) {
  const BackgroundMesh background = lattice(1.9, .1);
  const RegionDomain domain = RegionDomain::of_least({testing::zero(), ball({-.5, 0, 0}, 1), ball({.5, 0, 0}, 1)});
  const RegionMesh made = make_region_mesh(domain, background);
  ASSERT_EQ(made.status, UmStatus::Success);
  const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
  EXPECT_TRUE(failures(c, 3).empty()) << failures(c, 3)[0];
  EXPECT_GE(c.whole.quality.min, .62);
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v) {
    if (made.regions_at[v] != 7) continue;
    EXPECT_NEAR(domain.sheet(1, 0, made.mesh.V[v]), 0, 1e-6);
    EXPECT_NEAR(domain.sheet(2, 1, made.mesh.V[v]), 0, 1e-6);
  }
}

TEST(RegionMesh, ABallCutThroughItsCentreHasItsThreeSheets) {
  // Wedges of 90, 90 and nearly 180 degrees: two sheets at the curve are almost one.
  const BackgroundMesh background = lattice(1.5, .12);
  for (const Position& p : positions(2, .1)) {
    const PatchFunction whole = ball({0, 0, 0}, 1);
    const RegionDomain domain =
        RegionDomain::of_least({testing::zero(), placed(testing::tilted(whole, {.02, 0, 0}), p.R, p.shift),
                                placed(testing::tilted(whole, {-.02, 0, 0}), p.R, p.shift)});
    const RegionMesh made = make_region_mesh(domain, background);
    EXPECT_TRUE(made.defects.empty());
    const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
    EXPECT_TRUE(failures(c, 3).empty()) << failures(c, 3)[0];
    EXPECT_GE(c.whole.quality.min, .7);
    EXPECT_NEAR(measures_of(c, 1).certificate.volume, 2 * kPi / 3, .03);
  }
}

TEST(RegionMesh, EveryInterfaceFaceHasOneTetOnEitherSide) {
  const BackgroundMesh background = lattice(1.6, .15);
  const RegionMesh made = make_region_mesh(RegionDomain::of_bodies({ball({0, 0, 0}, 1)}), background);
  for (const InterfaceFace& f : made.interfaces) {
    EXPECT_EQ(made.region[f.tet], f.region);
    EXPECT_EQ(made.region[f.other_tet], f.other);
    const auto has_corner = [&](int tet, int v) {
      const Tet& t = made.mesh.C[tet];
      return std::find(t.begin(), t.end(), v) != t.end();
    };
    for (const int v : f.face) EXPECT_TRUE(has_corner(f.tet, v) && has_corner(f.other_tet, v));
  }
}

TEST(RegionMesh, WithoutTheOutsideTheBodiesAlone) {
  const BackgroundMesh background = lattice(1.6, .12);
  const RegionDomain domain = RegionDomain::of_bodies({ball({0, 0, 0}, 1), ball({0, 0, 0}, .5)});
  const RegionMesh made = make_region_mesh(domain, background, {.has_outside = false});
  EXPECT_TRUE(std::none_of(made.region.begin(), made.region.end(), [](int r) { return r == 0; }));
  const RegionCertificate c = certify_regions(made.mesh, made.region, &domain, background.h());
  EXPECT_TRUE(failures(c, 3).empty());
  EXPECT_EQ(c.interfaces.size(), 2U);
  for (const InterfaceFace& f : made.interfaces) EXPECT_EQ(f.other_tet < 0, f.other == 0);
}

TEST(RegionMesh, BytesAreTheSameForAnyNumberOfThreads) {
  const BackgroundMesh background = lattice(1.6, .15);
  const RegionDomain domain = RegionDomain::of_bodies({ball({-.3, 0, 0}, .9), ball({.4, .1, 0}, .7)});
  const auto with = [&](std::size_t n) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n);
    return make_region_mesh(domain, background);
  };
  const RegionMesh one = with(1), two = with(2);
  EXPECT_EQ(one.mesh.V, two.mesh.V);
  EXPECT_EQ(one.mesh.C, two.mesh.C);
  EXPECT_EQ(one.region, two.region);
}

TEST(RegionMesh, LostAndLeavingRegionsAreReported) {
  const BackgroundMesh background = lattice(1.6, .15);
  const RegionMesh lost =
      make_region_mesh(RegionDomain::of_bodies({ball({0, 0, 0}, 1), ball({.03, .04, .05}, .01)}), background);
  EXPECT_TRUE(std::any_of(lost.defects.begin(), lost.defects.end(),
                          [](const RegionDefect& d) { return d.kind == RegionDefect::Kind::Lost; }));
  EXPECT_EQ(make_region_mesh(RegionDomain::of_bodies({ball({0, 0, 0}, 2)}), background).status,
            UmStatus::DomainLeavesBackground);
  EXPECT_EQ(make_region_mesh(RegionDomain::of_bodies({ball({9, 0, 0}, 1)}), background).status, UmStatus::EmptyDomain);
}

TEST(RegionCertificate, OverlapAndMissingRegionsFail) {
  TetMesh two;
  two.V = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {.2, .2, .8}};
  two.C = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  const RegionCertificate c = certify_regions(two, {1, 2});
  EXPECT_FALSE(failures(c, 3).empty());
  two.C.resize(1);
  const std::vector<std::string> lost = failures(certify_regions(two, {1}), 3);
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0], "region 2 has no tet");
  EXPECT_THROW(certify_regions(two, {1, 2}), std::invalid_argument);
  EXPECT_THROW(certify_regions(two, {-1}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
