#include "mesh/regions/region_domain.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/regions.h"

namespace umtet {
namespace {

using testing::ball;

TEST(RegionDomain, LaterBodiesCoverEarlierOnes) {
  const RegionDomain domain = RegionDomain::of_bodies({ball({0, 0, 0}, 1), ball({.5, 0, 0}, 1)});
  EXPECT_EQ(domain.n_regions(), 3);
  EXPECT_EQ(domain.region({-.9, 0, 0}), 1);
  EXPECT_EQ(domain.region({.25, 0, 0}), 2);
  EXPECT_EQ(domain.region({3, 0, 0}), 0);
}

TEST(RegionDomain, AllSheetsOfABodyAreOnePatch) {
  const RegionDomain domain = RegionDomain::of_bodies({ball({0, 0, 0}, 1), ball({.5, 0, 0}, 1)});
  EXPECT_EQ(domain.patch(2, 0), domain.patch(1, 2));
  EXPECT_NE(domain.patch(1, 0), domain.patch(2, 0));
  EXPECT_LT(domain.sheet(2, 1, {.5, 0, 0}), 0);
}

TEST(RegionDomain, PsiOfTheBoundaryVanishesOnVisibleSheetsAlone) {
  const RegionDomain domain = RegionDomain::of_bodies({ball({0, 0, 0}, 1), ball({.5, 0, 0}, 1)});
  EXPECT_NEAR(domain.boundary().value({-1, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(domain.boundary().value({1.5, 0, 0}), 0, 1e-12);
  EXPECT_GT(std::abs(domain.boundary().value({1, 0, 0})), .1);  // of body 1, inside of body 2
}

TEST(RegionDomain, TheLeastFunctionDecides) {
  const RegionDomain domain = RegionDomain::of_least({ball({9, 0, 0}, 1), ball({-1, 0, 0}, 1), ball({1, 0, 0}, 1)});
  EXPECT_EQ(domain.region({-.5, .3, 0}), 1);
  EXPECT_EQ(domain.region({.5, .3, 0}), 2);
  EXPECT_NEAR(domain.sheet(2, 1, {0, .3, .2}), 0, 1e-12);
  EXPECT_LT(domain.sheet(2, 1, {.5, 0, 0}), 0);
  EXPECT_NEAR(domain.boundary().value({0, .3, .2}), 0, 1e-12);
}

TEST(RegionDomain, RefusesTooFewAndTooMany) {
  EXPECT_THROW(RegionDomain::of_bodies({}), std::invalid_argument);
  EXPECT_THROW(RegionDomain::of_bodies(std::vector<PatchFunction>(kMostRegions, ball({0, 0, 0}, 1))),
               std::invalid_argument);
  EXPECT_THROW(RegionDomain::of_least({ball({0, 0, 0}, 1)}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
