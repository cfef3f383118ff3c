#include "mesh/core/polyline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace umtet {
namespace {

std::vector<Vec3> helix(int n) {
  std::vector<Vec3> points;
  for (int k = 0; k <= n; ++k) points.emplace_back(std::cos(.3 * k), std::sin(.3 * k), .02 * k);
  return points;
}

TEST(Polyline, NearestIsThatOfAllSegments) {
  const std::vector<Vec3> points = helix(200);
  const Polyline line(points);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(-2, 4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x(at(random), at(random), at(random));
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const Vec3 d = points[k + 1] - points[k];
      const double t = std::clamp((x - points[k]).dot(d) / d.squaredNorm(), 0., 1.);
      least = std::min(least, (x - points[k] - t * d).norm());
    }
    const Polyline::Nearest found = line.nearest(x);
    EXPECT_NEAR(found.distance, least, 1e-12);
    EXPECT_NEAR((found.point - x).norm(), least, 1e-12);
    EXPECT_LT((line.at(found.arc) - found.point).norm(), 1e-12);
    EXPECT_NEAR(found.tangent.norm(), 1, 1e-12);
  }
}

TEST(Polyline, ArcsEndAtTheLength) {
  const Polyline line({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 2, 0)});
  EXPECT_EQ(line.length(), 3);
  EXPECT_EQ(line.at(0), Vec3(0, 0, 0));
  EXPECT_EQ(line.at(3), Vec3(1, 2, 0));
  EXPECT_EQ(line.at(2), Vec3(1, 1, 0));
}

}  // namespace
}  // namespace umtet
