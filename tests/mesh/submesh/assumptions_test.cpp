#include "mesh/submesh/assumptions.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "mesh/core/tet_quality.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/sizes/body_size.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

/// A positively cut tet by itself: vertex 3 is inside, the face of the others is positive.
Submesh one_tet(const Vec3& inside, const std::array<Vec3, 3>& face) {
  Submesh submesh;
  submesh.mesh = {{face[0], face[1], face[2], inside}, {{0, 2, 1, 3}}};
  submesh.positive_faces = {{0, 1, 2}};
  submesh.positive_tets = {0};
  submesh.positive_vertices = {0, 1, 2};
  return submesh;
}

std::vector<double> distances(const testing::AnalyticDomain& domain, const Submesh& submesh, double h) {
  std::vector<double> distance;
  for (const int i : submesh.positive_vertices) {
    distance.push_back(std::abs(closest_point(domain, submesh.mesh.V[i], h, {}).t));
  }
  return distance;
}

TEST(DoublePositiveFaces, TwoTetsOnAFaceAreOneOffender) {
  // Inside vertices 3 and 4 on both sides of the face 0 1 2; a third tet has a face of its own.
  Submesh submesh;
  submesh.mesh.V = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {.3, .3, -1}, {.3, .3, 1},
                    {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}};
  submesh.mesh.C = {{0, 2, 1, 3}, {0, 1, 2, 4}, {5, 6, 7, 8}};
  submesh.positive_faces = {{0, 1, 2}, {1, 0, 2}, {5, 7, 6}};
  submesh.positive_tets = {0, 1, 2};
  const BrokenAssumption broken = double_positive_faces(submesh);
  EXPECT_EQ(broken.count, 1u);
  EXPECT_EQ(broken.at_vertex, (std::vector<bool>{true, true, true, false, false, false, false, false, false}));
  EXPECT_TRUE(broken.is_broken_at(std::array{3, 2}));
  EXPECT_FALSE(broken.is_broken_at(std::array{3, 4, 5}));

  submesh.positive_faces.erase(submesh.positive_faces.begin() + 1);
  EXPECT_TRUE(double_positive_faces(submesh).holds());
  EXPECT_FALSE(double_positive_faces(submesh).is_broken_at(std::array{0, 1, 2}));
}

TEST(DoublePositiveFaces, AThinDiscHasThemAndAThickOneHasNot) {
  const BackgroundMesh background(a15(), testing::cube_box(1.3), .1);
  const Submesh thin = find_submesh(background, testing::ellipsoid({1, 1, .03}));  // a third of an edge to each side
  EXPECT_GT(double_positive_faces(thin).count, 0u);
  EXPECT_TRUE(double_positive_faces(find_submesh(background, testing::ellipsoid({1, 1, .3}))).holds());
}

TEST(ConditioningAngles, OnA15AreAcuteWhateverTheDomain) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    const double h = h_for_tets(domain, domain.box, 10000);
    const Submesh submesh = find_submesh(BackgroundMesh(a15(), domain.box, h), domain);
    const ConditioningAngles angles = conditioning_angles(submesh, distances(domain, submesh, h));
    EXPECT_TRUE(angles.not_acute.holds()) << domain.name;
    EXPECT_LT(angles.max_deg, 78.4631) << domain.name;  // the greatest dihedral angle of A15 is acos(1/5)
    EXPECT_GT(angles.max_deg, 53.1301) << domain.name;  // and the least is acos(3/5)
  }
}

TEST(ConditioningAngles, AreThoseAtTheProximalVertex) {
  // The foot of the inside vertex lies beyond edge (1, 2): the angle there is obtuse, those at (0, 1) and (0, 2) are
  // not. Only with vertex 0 as the proximal one does the obtuse angle stay out.
  const Submesh submesh = one_tet({.7, .7, -.5}, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  const auto& V = submesh.mesh.V;
  const double at_01 = dihedral_angle_deg(V[0], V[1], V[2], V[3]), at_02 = dihedral_angle_deg(V[0], V[2], V[1], V[3]),
               at_12 = dihedral_angle_deg(V[1], V[2], V[0], V[3]);
  ASSERT_GT(at_12, 90);

  const ConditioningAngles good = conditioning_angles(submesh, std::array{.1, .2, .3});
  EXPECT_EQ(good.max_deg, std::max(at_01, at_02));
  EXPECT_TRUE(good.not_acute.holds());

  for (const auto& distance : {std::array{.2, .1, .3}, std::array{.3, .2, .1}}) {
    const ConditioningAngles bad = conditioning_angles(submesh, distance);
    EXPECT_EQ(bad.max_deg, at_12);
    EXPECT_EQ(bad.not_acute.count, 1u);
    EXPECT_EQ(bad.not_acute.at_vertex, std::vector<bool>(4, true));
  }
}

TEST(ConditioningAngles, ARightAngleIsNotAcute) {
  // A corner of a cube: all its angles at the face are right or 54.7 degrees.
  const Submesh submesh = one_tet({0, 0, -1}, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  EXPECT_EQ(conditioning_angles(submesh, std::array{0., 1., 1.}).not_acute.count, 1u);
}

TEST(ConditioningAngles, NeedADistancePerPositiveVertex) {
  const Submesh submesh = one_tet({0, 0, -1}, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  EXPECT_THROW(conditioning_angles(submesh, std::array{0., 1.}), std::invalid_argument);
  EXPECT_EQ(conditioning_angles(Submesh{}, {}).max_deg, 0);
}

}  // namespace
}  // namespace umtet
