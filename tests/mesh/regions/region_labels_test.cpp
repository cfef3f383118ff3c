#include "mesh/regions/region_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "mesh/classification/configuration_costs.h"
#include "tests/support/regions.h"

namespace umtet {
namespace {

using testing::ball;

const Box kBox(Vec3::Constant(-1.6), Vec3::Constant(1.6));

RegionLabels labels_of(const RegionDomain& domain, const BackgroundMesh& background, RegionLabelParams params = {}) {
  return choose_labels(domain, background, *background_costs(background)->links, params);
}

TEST(RegionLabels, SignsAloneLeaveVerticesThatAreNotValid) {
  const BackgroundMesh background(a15(), kBox, .12);
  const RegionDomain domain = RegionDomain::of_bodies({ball({.01, .02, .03}, 1)});
  const RegionLabels made = labels_of(domain, background, {.max_sweeps = 0, .pair_rounds = 0, .annealing_rounds = 0});
  EXPECT_GT(made.n_invalid_at_start, made.n_interface / 20);
  EXPECT_EQ(made.invalid.size(), made.n_invalid_at_start);
}

TEST(RegionLabels, EveryVertexOfASphereBecomesValid) {
  const BackgroundMesh background(a15(), kBox, .12);
  for (const double x : {0., .013, .029, .047, .06}) {
    const RegionLabels made = labels_of(RegionDomain::of_bodies({ball({x, 2 * x, -x}, 1)}), background);
    EXPECT_GT(made.n_changes, 0U);
    EXPECT_TRUE(made.invalid.empty()) << x;
  }
}

TEST(RegionLabels, VerticesOfCurvesAndCornersBecomeValid) {
  const BackgroundMesh background(a15(), kBox, .1);
  const PatchFunction f = ball({0, 0, 0}, 1);
  const RegionDomain domain =
      RegionDomain::of_least({testing::zero(), testing::tilted(f, {.3, 0, 0}), testing::tilted(f, {-.3, .25, 0}),
                              testing::tilted(f, {0, -.3, 0})});
  const RegionLabels made = labels_of(domain, background);
  EXPECT_FALSE(made.leaves_background);
  EXPECT_GT(made.n_invalid_at_start, 50U);
  EXPECT_LE(made.invalid.size(), 2U);
}

TEST(RegionLabels, LabelsStayWithinReachOfTheirRegions) {
  const BackgroundMesh background(a15(), kBox, .12);
  const RegionDomain domain = RegionDomain::of_bodies({ball({.01, .02, .03}, 1)});
  const RegionLabels made = labels_of(domain, background);
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    if (!background.has_tets(v)) continue;
    const double r = (background.position(v) - Vec3(.01, .02, .03)).norm();
    if (r < 1 - 2 * .12) {
      EXPECT_EQ(made.of_vertex[v], 1);
    } else if (r > 1 + .12) {
      EXPECT_EQ(made.of_vertex[v], 0);
    }
  }
}

TEST(RegionLabels, ARegionThatReachesTheBackgroundBoundaryIsReported) {
  const BackgroundMesh background(a15(), kBox, .12);
  EXPECT_TRUE(labels_of(RegionDomain::of_bodies({ball({0, 0, 0}, 2)}), background).leaves_background);
}

TEST(RegionLabels, NamesEveryBrokenConstraint) {
  const BackgroundMesh background(a15(), kBox, .5);
  const RegionDomain domain = RegionDomain::of_bodies({ball({0, 0, 0}, 1)});
  EXPECT_THROW(labels_of(domain, background, {.shift = 2}), std::invalid_argument);
  EXPECT_EQ(
      problems(RegionLabelParams{.shift = -1, .reach = 0, .distance_weight = -1, .max_sweeps = -1, .pair_rounds = -1})
          .size(),
      5U);
}

}  // namespace
}  // namespace umtet
