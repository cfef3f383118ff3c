#include "mesh/fast/defects/patch_state.h"

#include <gtest/gtest.h>

#include "tests/support/domains.h"

namespace umtet {
namespace {

TEST(NormalCosine, IsThatOfTheFaceWithTheSurfaceBelowOrAboveIt) {
  const testing::AnalyticDomain ball = testing::sphere();
  std::size_t n = 0;
  for (const double r : {.8, 1., 1.2}) {
    const Vec3 a(.1, 0, r), b(-.05, .08, r), c(-.05, -.08, r);
    EXPECT_NEAR(normal_cosine(ball, a, b, c, .1, n), 1, 1e-6);
    EXPECT_NEAR(normal_cosine(ball, a, c, b, .1, n), -1, 1e-6);
  }
  // Tilted by 60 degrees about its centroid.
  const Vec3 at(0, 0, 1), u = .1 * Vec3(.5, 0, std::sqrt(.75)), v(0, .1, 0);
  EXPECT_NEAR(normal_cosine(ball, at + u, at - .5 * u + v, at - .5 * u - v, .1, n), .5, 1e-6);
  EXPECT_EQ(normal_cosine(ball, at, at, at + v, .1, n), -1);
  EXPECT_GT(n, 0u);
}

TEST(PositiveFace, IsThatOfThreeOutsideVerticesSeenFromOutside) {
  Triangle f;
  const Tet t = {0, 1, 2, 3};
  ASSERT_TRUE(positive_face(t, {0, 1, 0, 0}, f));
  EXPECT_EQ(f, (Triangle{0, 3, 2}));
  for (const std::vector<std::uint8_t>& inside : {std::vector<std::uint8_t>{0, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 1}})
    EXPECT_FALSE(positive_face(t, inside, f));
}

TEST(PatchState, CountsTetsAndFaces) {
  // A tet with its vertex 0 in the ball and the face opposite to it above the surface; then with that face misaligned
  // over.
  const testing::AnalyticDomain ball = testing::sphere();
  ActiveLayer layer;
  layer.h = .2;
  layer.V = {{0, 0, .8}, {.1, 0, 1}, {-.05, .08, 1}, {-.05, -.08, 1}};
  layer.C = {{0, 1, 2, 3}};
  std::size_t n = 0;
  PatchState s = patch_state(layer, {1, 0, 0, 0}, ball, .82, n);
  EXPECT_EQ(s.misaligned, 0u);
  EXPECT_NEAR(s.least_cosine, 1, 1e-6);
  EXPECT_GT(s.least, 0);
  std::swap(layer.V[2], layer.V[3]);
  s = patch_state(layer, {1, 0, 0, 0}, ball, .82, n);
  EXPECT_EQ(s.below_target, 1u);
  EXPECT_EQ(s.misaligned, 1u);
  EXPECT_EQ(s.folded_over, 1u);
  EXPECT_LT(s.least, 0);
  EXPECT_NEAR(s.least_cosine, -1, 1e-6);
  EXPECT_FALSE(s.is_perfect());
}

TEST(PatchState, NoneOfTheFiveMayGetWorse) {
  const PatchState s{.82, .7, 3, .2, 4, 0};
  EXPECT_TRUE(s.is_no_worse_than(s));
  EXPECT_FALSE(s.is_better_than(s));
  // A change for the worse, with another one for the better.
  for (const PatchState& other :
       {PatchState{.82, .69, 2, .2, 4, 0}, PatchState{.82, .75, 4, .2, 4, 0}, PatchState{.82, .7, 2, .1, 4, 0},
        PatchState{.82, .7, 2, .3, 5, 0}, PatchState{.82, .7, 0, .3, 3, 1}}) {
    EXPECT_FALSE(other.is_no_worse_than(s));
  }
  for (const PatchState& other : {PatchState{.82, .71, 3, .2, 4, 0}, PatchState{.82, .7, 2, .2, 4, 0},
                                  PatchState{.82, .7, 3, .3, 4, 0}, PatchState{.82, .7, 3, .2, 3, 0}}) {
    EXPECT_TRUE(other.is_no_worse_than(s) && other.is_better_than(s) && !s.is_no_worse_than(other));
  }
  // Fewer misaligned faces, none of them folded over: the worst one may be misaligned more.
  EXPECT_TRUE((PatchState{.82, .7, 3, .1, 3, 0}).is_no_worse_than(s));
  EXPECT_FALSE((PatchState{.82, .7, 3, -.1, 3, 1}).is_no_worse_than(s));
  // Beyond the target, and beyond kMisalignedCosine, there is nothing to keep.
  EXPECT_TRUE((PatchState{.82, .83, 0, .6, 0, 0}).is_no_worse_than({.82, .9, 0, .9, 0, 0}));
  EXPECT_FALSE((PatchState{.82, .9, 0, .9, 0, 0}).is_better_than({.82, .83, 0, .6, 0, 0}));
}

}  // namespace
}  // namespace umtet
