#include "body/fitted_level_set.h"

#include <gtest/gtest.h>

#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {

LevelSet some_levels() {
  SsdParams params;
  params.spacing = .08;
  params.coarsest_nodes = 2500;
  return fit_ssd(test::torus_cloud(8000), params).psi;
}

TEST(FittedLevelSet, GetsAgainWhatItHasPutAside) {
  const LevelSet psi = some_levels();
  const int n = psi.n_levels();
  ASSERT_GE(n, 3);
  int n_calls = 0;
  FittedLevelSet fitted(psi, [&] {
    ++n_calls;
    return psi;
  });
  fitted.put_aside_below(1.5 * psi.spacing());
  EXPECT_EQ(fitted.held().n_levels(), n - 1);
  // What is there is not asked for.
  EXPECT_EQ(fitted.band_limited(1.5 * psi.spacing()).n_levels(), n - 1);
  EXPECT_EQ(fitted.band_limited(1.01 * psi.spacing()).n_levels(), n - 1);
  EXPECT_EQ(fitted.band_limited(3 * psi.spacing()).n_levels(), n - 2);
  EXPECT_EQ(n_calls, 0);
  EXPECT_EQ(fitted.band_limited(psi.spacing()).n_levels(), n);
  EXPECT_EQ(n_calls, 1);
  EXPECT_EQ(fitted.held().n_levels(), n);
  fitted.put_aside_below(10);
  fitted.put_aside_below(10);
  EXPECT_EQ(fitted.held().n_levels(), 1);
  EXPECT_EQ(fitted.whole().n_levels(), n);
  EXPECT_EQ(fitted.whole().n_levels(), n);
  EXPECT_EQ(n_calls, 2);
}

TEST(FittedLevelSet, PutsNothingAsideThatNobodyCanMakeAgain) {
  const LevelSet psi = some_levels();
  FittedLevelSet fitted(psi);
  fitted.put_aside_below(10);
  EXPECT_EQ(fitted.held().n_levels(), psi.n_levels());
  EXPECT_EQ(fitted.whole().n_levels(), psi.n_levels());
}

}  // namespace
}  // namespace umtet
