#include "mesh/features/feature_embedding.h"

#include <gtest/gtest.h>

#include <cmath>

namespace umtet {
namespace {

// docs: one tet in a wedge of 20, 30, 45, 60 degrees, and how many tets are best at 90 to 270.
TEST(BestWedgeQuality, IsThatOfEqualTetsAroundAnEdge) {
  EXPECT_NEAR(best_wedge_quality(20, 1), .604, 5e-4);
  EXPECT_NEAR(best_wedge_quality(30, 1), .760, 5e-4);
  EXPECT_NEAR(best_wedge_quality(45, 1), .913, 5e-4);
  EXPECT_NEAR(best_wedge_quality(60, 1), .986, 5e-4);
  EXPECT_NEAR(best_wedge_quality(90, 1), .961, 5e-4);
  EXPECT_NEAR(best_wedge_quality(90, 2), best_wedge_quality(45, 1), 1e-12);
  EXPECT_GT(best_wedge_quality(120, 2), best_wedge_quality(120, 1));
  EXPECT_GT(best_wedge_quality(270, 4), best_wedge_quality(270, 3));
  EXPECT_EQ(best_wedge_quality(200, 1), 0);
}

}  // namespace
}  // namespace umtet
