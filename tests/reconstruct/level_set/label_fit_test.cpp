#include "reconstruct/level_set/label_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/support/label_volumes.h"

namespace umtet {
namespace {

/// A ball of radius 8 in two halves, as labels 3 and 5.
double two_halves(const Vec3& x) {
  if (x.norm() >= 8) return 0;
  return x[2] < 0 ? 3 : 5;
}

std::size_t least_of(const std::vector<LabelLevelSet>& functions, const Vec3& x) {
  std::size_t least = 0;
  for (std::size_t k = 1; k < functions.size(); ++k)
    if (functions[k].evaluate(x, nullptr, nullptr) < functions[least].evaluate(x, nullptr, nullptr)) least = k;
  return least;
}

TEST(LabelFit, TheLeastFunctionAtACentreIsThatOfItsLabel) {
  const Grid grid = label_volume_of({24, 24, 24}, Vec3::Ones(), two_halves);
  const std::vector<LabelLevelSet> functions = fit_labels(grid, {3, 5});
  ASSERT_EQ(functions.size(), 3U);
  std::size_t n_wrong = 0;
  for (int k = 0; k < grid.n[2]; ++k)
    for (int j = 0; j < grid.n[1]; ++j)
      for (int i = 0; i < grid.n[0]; ++i) {
        const Vec3 x = grid.origin + grid.axes * Vec3(i, j, k);
        const double label = two_halves(x);
        n_wrong += least_of(functions, x) != (label == 0 ? 0U : label == 3 ? 1U : 2U) ? 1 : 0;
      }
  EXPECT_EQ(n_wrong, 0U);
}

TEST(LabelFit, NoGapOpensBetweenLabelsThatTouch) {
  const Grid grid = label_volume_of({24, 24, 24}, Vec3::Ones(), two_halves);
  const std::vector<LabelLevelSet> functions = fit_labels(grid, {3, 5});
  for (double r = 0; r < 6.5; r += .37)
    for (double a = 0; a < 6.28; a += .4)
      for (double z = -.6; z < .6; z += .05)
        EXPECT_NE(least_of(functions, Vec3(r * std::cos(a), r * std::sin(a), z)), 0U);
}

TEST(LabelFit, FarFromASurfaceTheValueIsConstant) {
  const Grid grid = label_volume_of({24, 24, 24}, Vec3::Ones(), two_halves);
  const std::vector<LabelLevelSet> functions = fit_labels(grid, {3, 5});
  Vec3 gradient = Vec3::Ones();
  EXPECT_EQ(functions[1].evaluate(Vec3(0, 0, 50), &gradient, nullptr), 4);
  EXPECT_EQ(gradient, Vec3::Zero());
  EXPECT_EQ(functions[0].evaluate(Vec3(0, 0, 50), nullptr, nullptr), -4);
  EXPECT_EQ(functions[0].evaluate(Vec3(0, 0, .5), nullptr, nullptr), 4);
  // Near it, it is the function of the mask, the outside with the other sign.
  EXPECT_NEAR(functions[0].evaluate(Vec3(0, 7.9, 0), nullptr, nullptr), 0, .6);
  EXPECT_GT(functions[0].evaluate(Vec3(0, 7, 0), nullptr, nullptr), 0);
}

TEST(LabelFit, ALabelWithoutVoxelsIsRefused) {
  const Grid grid = label_volume_of({24, 24, 24}, Vec3::Ones(), two_halves);
  EXPECT_THROW(fit_labels(grid, {3, 4}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
