// Places of formulas whose features are known.

#include "body/fidelity/mesh_defects.h"

#include <gtest/gtest.h>

#include "body/fidelity/lost_ends.h"
#include "body/fidelity/lost_surface.h"
#include "body/pieces/clusters.h"
#include "mesh/expression/expression.h"

namespace umtet {
namespace {

Domain domain_of(const std::string& formula, const Vec3& corner) {
  Domain domain;
  domain.formula = shared_function(Expression(formula));
  domain.box = Box(-corner, corner);
  domain.diagonal = domain.box.diagonal().norm();
  return domain;
}

// Two unit balls .1 apart.
const char* const kTwins = "((x-1.05)^2+y^2+z^2-1)*((x+1.05)^2+y^2+z^2-1)";

TEST(Clusters, JoinWhatIsNear) {
  const std::vector<Vec3> x = {{0, 0, 0}, {5, 0, 0}, {1.9, 0, 0}, {5, .5, 0}};
  const std::vector<int> set = clusters(x, 1);
  EXPECT_EQ(set, (std::vector<int>{0, 1, 0, 1}));
  EXPECT_EQ(members_of(set), (std::vector<std::vector<int>>{{0, 2}, {1, 3}}));
}

TEST(MeshDefects, HaveTheFeatureOfPsiAndTheHThatShowsIt) {
  Domain twins = domain_of(kTwins, {2.6, 1.4, 1.4});
  twins.shift = Vec3(10, 0, 0);
  const std::vector<Difference> differences = {{DefectKind::Folded, Vec3(.05, 0, 0), .01},
                                               {DefectKind::Folded, Vec3(-.05, 0, 0), .02},
                                               {DefectKind::Off, Vec3(.05, 0, 0), .03},
                                               {DefectKind::Folded, Vec3(2.05, 0, 0), .01}};
  const std::vector<MeshDefect> defects = defects_of(twins, differences, .2);
  ASSERT_EQ(defects.size(), 3u);
  EXPECT_EQ(defects[0].kind, DefectKind::Folded);
  EXPECT_EQ(defects[0].n, 2u);
  EXPECT_NEAR(defects[0].off_over_h, .1, 1e-12);
  EXPECT_NEAR((defects[0].where - Vec3(9.95, 0, 0)).norm(), 0, 1e-12);
  ASSERT_TRUE(defects[0].feature_over_h);
  EXPECT_NEAR(*defects[0].feature_over_h, .5, .02);  // the gap of .1
  EXPECT_NEAR(*defects[0].h_needed, .1 / kLeastEdgesAcross, .005);
  EXPECT_TRUE(is_small(defects[0]));
  EXPECT_FALSE(defects[1].feature_over_h);  // a ball of radius 5 h, far from the other: nothing is fine there
  EXPECT_TRUE(is_small(defects[1])) << "no larger than a face";
  EXPECT_EQ(defects[2].kind, DefectKind::Off);
}

TEST(MeshDefects, AreSmallWhereCurvatureIsFinerThanH) {
  // At its ends the spindle has radius of curvature .2^2 / 1 = .04, and is thinner than that on the way there.
  const Domain spindle = domain_of("x^2+(y/0.2)^2+(z/0.2)^2-1", {1.2, .4, .4});
  const std::vector<Difference> at_end = {{DefectKind::Off, Vec3(1, 0, 0), .01}};
  const std::vector<MeshDefect> defects = defects_of(spindle, at_end, .1);
  ASSERT_TRUE(defects[0].feature_over_h);
  EXPECT_NEAR(*defects[0].feature_over_h, .8, .01);  // 2 x .04 / .1
  EXPECT_FALSE(defects_of(spindle, at_end, .03)[0].feature_over_h);
}

TEST(MeshDefects, ATopologyThatDiffersIsWherePsiIsThin) {
  const Domain twins = domain_of(kTwins, {2.6, 1.4, 1.4});
  const ZeroSetChoice counted = choose_components(twins, .1);
  // A boundary that is far from all of it but for one point of the gap.
  const std::vector<Vec3> V = {{0, .1, 0}, {0, -.1, .1}, {0, -.1, -.1}};
  const MeshDefect defect = topology_defect(twins, counted, SurfaceDistance(V, {{0, 1, 2}}), .2, 3);
  EXPECT_EQ(defect.n, 3u);
  EXPECT_LT(std::abs(defect.where.x()), .2);
  ASSERT_TRUE(defect.feature_over_h);
  EXPECT_LT(*defect.feature_over_h, kLeastEdgesAcross);
  EXPECT_GT(defect.off_over_h, 9);  // the far ends of the balls have no boundary near them
}

TEST(LostEnds, AWireIsFollowedToItsEndFromWhereTheMeshEnds) {
  // 6 long and .1 thick: a mesh of edge length 1 has hardly anything of it.
  const Domain wire = domain_of("(x/3)^2+(y/0.05)^2+(z/0.05)^2-1", {4, 1, 1});
  const std::vector<Vec3> V = {{.5, .1, 0}, {.5, -.1, .1}, {.5, -.1, -.1}};
  const SurfaceDistance boundary(V, {{0, 1, 2}});
  const std::vector<LostPoint> lost = lost_ends(wire, {Vec3(.5, 0, .05)}, boundary, 1, .5);
  ASSERT_FALSE(lost.empty());
  double left = 0, right = 0;
  for (const LostPoint& p : lost) {
    EXPECT_GT(p.distance, .5);
    EXPECT_LT(std::abs(wire.value(p.where)), 1e-6);
    left = std::min(left, p.where.x());
    right = std::max(right, p.where.x());
  }
  EXPECT_LT(left, -2.9);
  EXPECT_GT(right, 2.9);
}

TEST(LostEnds, WhereTheBoundaryIsOnPsiThereAreNone) {
  const Domain ball = domain_of("x^2+y^2+z^2-1", {2, 2, 2});
  // An octahedron: between its faces and the ball lies at most 1 - 1 / sqrt(3) = .42.
  const std::vector<Vec3> V = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> faces;
  for (const int x : {0, 1}) {
    for (const int y : {2, 3}) {
      for (const int z : {4, 5}) faces.push_back({x, y, z});
    }
  }
  EXPECT_TRUE(lost_ends(ball, V, SurfaceDistance(V, faces), 1, .5).empty());
}

TEST(LostSurface, APlateIsFollowedToItsRimFromOnePointOfIt) {
  // 6 x 4 x .1, and a triangle in its middle.
  const Domain plate = domain_of("(x/3)^4+(y/2)^4+(z/0.05)^4-1", {4, 3, 1});
  const SurfaceDistance boundary({{.5, .1, 0}, {.5, -.1, .1}, {.5, -.1, -.1}}, {{0, 1, 2}});
  const std::vector<LostPoint> lost =
      lost_surface(plate, {{{0, 1, .05 * std::pow(1 - 1. / 16, .25)}, 1}}, boundary, 1, .5);
  for (const LostPoint& p : lost) {
    EXPECT_GT(p.distance, .5);
    EXPECT_LT(std::abs(plate.value(p.where)), 1e-6);
  }
  // No point of either face that is lost is farther than two cubes from one that was found.
  for (double x = -2.5; x <= 2.5; x += .25) {
    for (double y = -1.5; y <= 1.5; y += .25) {
      for (const double z : {-.05, .05}) {
        const Vec3 at(x, y, z);
        if (boundary.distance(at) < .6) continue;
        double least = 10;
        for (const LostPoint& p : lost) least = std::min(least, (p.where - at).norm());
        EXPECT_LT(least, 1) << at.transpose();
      }
    }
  }
}

TEST(LostSurface, ItEndsWhereTheBoundaryIsNear) {
  const Domain ball = domain_of("x^2+y^2+z^2-1", {2, 2, 2});
  // A triangle by one pole: what is lost lies more than .5 from it.
  const SurfaceDistance boundary({{1, 0, 0}, {1, .1, 0}, {1, 0, .1}}, {{0, 1, 2}});
  const std::vector<LostPoint> lost = lost_surface(ball, {{{0, 0, 1}, 1}}, boundary, .2, 2.5);
  ASSERT_GT(lost.size(), 500u);  // 4 pi / .1^2 is 1257
  double farthest = -1, nearest = 2;
  for (const LostPoint& p : lost) {
    farthest = std::max(farthest, -p.where.x());
    nearest = std::min(nearest, p.distance);
  }
  EXPECT_GT(farthest, .99);
  EXPECT_GT(nearest, .5);
  EXPECT_LT(nearest, .6);
}

}  // namespace
}  // namespace umtet
