#include "mesh/core/piecewise_domain.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "mesh/core/boundary_strata.h"
#include "tests/support/domains.h"
#include "tests/support/piecewise_bodies.h"

namespace umtet {
namespace {

using testing::ball_at;
using testing::half_space;

TEST(PiecewiseDomain, ValueIsMaxAndMinOfItsPatches) {
  const PiecewiseDomain a = half_space({}, {1, 0, 0}, .5), b = half_space({}, {0, 1, 0}, .25),
                        c = ball_at({}, {0, 0, 0}, 1);
  const PiecewiseDomain domain = united(intersection(a, b), complement(c));
  ASSERT_EQ(domain.n_patches(), 3);
  for (const Vec3& x : {Vec3(.1, .2, .3), Vec3(2, .1, 0), Vec3(.6, .4, .2), Vec3(-1, -2, 3)}) {
    const double expected = std::min(std::max(x.x() - .5, x.y() - .25), 1 - x.squaredNorm());
    EXPECT_DOUBLE_EQ(domain.value(x), expected);
    Vec3 g;
    domain.evaluate(x, &g, nullptr);
    const Vec3 e(1e-6, 2e-6, -1e-6);
    EXPECT_NEAR(domain.value(x + e) - domain.value(x - e), 2 * g.dot(e), 1e-10);
  }
}

TEST(PiecewiseDomain, AnyFunctionWithSecondDerivativesIsAPatch) {
  const PiecewiseDomain domain = PiecewiseDomain::of(testing::sphere());
  EXPECT_DOUBLE_EQ(domain.value({0, 0, 2}), testing::sphere().value({0, 0, 2}));
  EXPECT_EQ(domain.n_patches(), 1);
}

TEST(PiecewiseDomain, CopiesOfOneFunctionAreOnePatch) {
  const PiecewiseDomain plane = half_space({}, {1, 0, 0}, 0), ball = ball_at({}, {0, 0, 0}, 1);
  EXPECT_EQ(united(intersection(plane, ball), plane).n_patches(), 2);
  EXPECT_THROW(intersection(plane, complement(plane)), std::invalid_argument);
}

TEST(PiecewiseDomain, SignsAloneDecideTheRegion) {
  const PiecewiseDomain a = half_space({}, {1, 0, 0}, 0), b = half_space({}, {0, 1, 0}, 0),
                        c = half_space({}, {0, 0, 1}, 0);
  const PiecewiseDomain domain = intersection(united(a, b), complement(c));
  for (int signs = 0; signs < 8; ++signs) {
    std::array<double, 3> few, far;
    for (int p = 0; p < 3; ++p) {
      const double sign = (signs >> p & 1) != 0 ? 1 : -1;
      few[p] = sign;
      far[p] = sign * (1 + 100 * p);
    }
    const bool is_inside = (few[0] < 0 || few[1] < 0) && few[2] > 0;
    EXPECT_EQ(domain.region(few), is_inside ? 1 : 0);
    EXPECT_EQ(domain.region(far), domain.region(few));
  }
}

class Strata : public ::testing::Test {
 protected:
  // A lens: two balls that meet in the circle of radius sqrt(3) / 2 around the z axis.
  const PiecewiseDomain lens = intersection(ball_at({}, {0, 0, .5}, 1), ball_at({}, {0, 0, -.5}, 1));
  const BoundaryStrata strata{lens,
                              {{.dimension = 2, .patches = {0}, .ends = {}},
                               {.dimension = 2, .patches = {1}, .ends = {}},
                               {.dimension = 1, .patches = {0, 1}, .ends = {}},
                               {.dimension = 0, .patches = {0, 1}, .place = {1, 2, 3}, .ends = {}}}};
};

TEST_F(Strata, FeetAreOnTheirZeroSets) {
  Vec3 foot;
  ASSERT_TRUE(strata.foot(2, {.9, .1, .05}, .2, foot));
  EXPECT_NEAR(foot.z(), 0, 1e-12);
  EXPECT_NEAR(foot.head<2>().norm(), std::sqrt(.75), 1e-12);
  ASSERT_TRUE(strata.foot(0, {.1, .2, -.45}, .2, foot));
  EXPECT_NEAR(lens.patch(0, foot), 0, 1e-12);
  EXPECT_FALSE(strata.foot(0, {.1, .2, 5}, .2, foot)) << "farther than 2 h";
}

TEST_F(Strata, AFootBeyondTheCurvesOfAPatchIsRefused) {
  Vec3 foot;
  // The lower ball of the lens ends at z = 0; its zero set goes on.
  const Vec3 beyond(std::sqrt(1 - .36), 0, .5 - .6 + .2);
  EXPECT_FALSE(strata.foot(0, beyond, .2, foot));
}

TEST(StrataWithBorders, PsiIsNotAskedInABallFarFromTheBorder) {
  // The wedge x < 0, z < 0. Its faces are the patches, and the y axis is the curve between them.
  const auto plane = [](const Vec3& n) {
    return [n](const Vec3& x, Vec3* g, Mat3* H) {
      if (g) *g = n;
      if (H) H->setZero();
      return n.dot(x);
    };
  };
  int n_asked = 0;
  const PiecewiseDomain wedge =
      PiecewiseDomain::of_patches({plane({1, 0, 0}), plane({0, 0, 1})}, [&n_asked](const Vec3& x) {
        ++n_asked;
        return x.x() > x.z() ? ActivePatch{x.x(), 0} : ActivePatch{x.z(), 1};
      });
  const auto axis = std::make_shared<const Polyline>(std::vector<Vec3>{{0, -5, 0}, {0, 5, 0}});
  const Stratum top{.dimension = 2, .patches = {1}, .ends = {}, .border = {{axis}}},
      unknown{.dimension = 2, .patches = {1}, .ends = {}},
      curve{.dimension = 1, .patches = {0, 1}, .ends = {}, .course = axis};
  const BoundaryStrata strata(wedge, {top, unknown, curve});

  const BallOnPatch ball = strata.ball_on_patch(0, {-.8, .1, 0}, .2);
  EXPECT_DOUBLE_EQ(ball.radius, .4);
  EXPECT_EQ(n_asked, 1);
  Vec3 foot;
  EXPECT_TRUE(strata.foot(0, {-.5, .1, .1}, .2, foot, &ball));
  EXPECT_EQ(foot, Vec3(-.5, .1, 0));
  EXPECT_EQ(n_asked, 1) << "inside of the ball";
  EXPECT_TRUE(strata.foot(0, {-.3, .1, .1}, .2, foot, &ball));
  EXPECT_EQ(n_asked, 2) << "outside of the ball";
  EXPECT_FALSE(strata.foot(0, {.1, .1, .1}, .2, foot, &ball)) << "beyond the curve";

  EXPECT_EQ(strata.ball_on_patch(0, {.8, .1, 0}, .2).radius, 0) << "not on the boundary";
  EXPECT_EQ(strata.ball_on_patch(1, {-.8, .1, 0}, .2).radius, 0) << "no border is known";
  EXPECT_EQ(strata.ball_on_patch(2, {0, .1, 0}, .2).radius, 0) << "on a curve";
}

TEST_F(Strata, FreeDirectionsAreTangents) {
  const Vec3 on_curve(std::sqrt(.75), 0, 0);
  const FreeDirections along = strata.directions(2, on_curve);
  ASSERT_EQ(along.n, 1);
  EXPECT_NEAR(std::abs(along.tangents.col(0).y()), 1, 1e-12);
  EXPECT_EQ(strata.directions(0, on_curve).n, 2);
  EXPECT_EQ(strata.directions(3, on_curve).n, 0);
}

TEST_F(Strata, AFaceIsOnTheOnlyPatchThatItsCornersShare) {
  EXPECT_EQ(strata.patch_of(0, 2, 2), 0);
  EXPECT_EQ(strata.patch_of(1, 2, 3), 1);
  EXPECT_EQ(strata.patch_of(2, 2, 2), -2);
  EXPECT_EQ(strata.patch_of(0, 1, 2), -2);
  EXPECT_TRUE(strata.is_in_closure(2, 0));
  EXPECT_FALSE(strata.is_in_closure(0, 2));
}

}  // namespace
}  // namespace umtet
