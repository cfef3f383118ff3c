#include "reconstruct/solve/turned_fit.h"

#include <gtest/gtest.h>

#include <random>

namespace umtet::test {
namespace {

/// A ball, some of whose normals point inward.
OrientedPointCloud ball_cloud(double share_turned) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::bernoulli_distribution is_turned(share_turned);
  OrientedPointCloud cloud;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x = Vec3(normal(random), normal(random), normal(random)).normalized();
    cloud.points.push_back(x);
    cloud.normals.push_back(is_turned(random) ? Vec3(-x) : x);
  }
  return cloud;
}

SsdParams coarse() {
  SsdParams params;
  params.spacing = .2;  // psi cannot follow single normals
  return params;
}

std::size_t n_inward(const OrientedPointCloud& cloud) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) n += cloud.normals[i].dot(cloud.points[i]) < 0;
  return n;
}

TEST(TurnedFit, TurnsWhatPsiOpposes) {
  OrientedPointCloud cloud = ball_cloud(.25);
  ASSERT_GT(n_inward(cloud), 600u);
  const SsdFit fit = fit_turning_opposed(cloud, coarse());
  EXPECT_LT(n_inward(cloud), 60u) << "so few stay as they are";
  EXPECT_GT(fit.report.n_turned_normals, 600u);
  EXPECT_LT(opposed_share(fit.report), .02);
  EXPECT_NEAR(fit.psi.value(Vec3(0, .8, 0)), -.2, .01);
}

TEST(TurnedFit, FewThatAreOpposedStayAsTheyAre) {
  OrientedPointCloud cloud = ball_cloud(.05);
  const std::size_t n = n_inward(cloud);
  const SsdFit fit = fit_turning_opposed(cloud, coarse());
  EXPECT_EQ(n_inward(cloud), n);
  EXPECT_EQ(fit.report.n_turned_normals, 0u);
  EXPECT_EQ(fit.report.n_opposed_normals, n);
}

}  // namespace
}  // namespace umtet::test
