#include "reconstruct/cloud/transfer/label_votes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "reconstruct/cloud/cleaning/cleaning.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {

int side(const Vec3& x) { return x.x() < 0 ? -3 : 8; }

OrientedPointCloud two_halves(int n) {
  OrientedPointCloud cloud = test::torus_cloud(n);
  for (const Vec3& x : cloud.points) cloud.labels.push_back(side(x));
  return cloud;
}

TEST(VoteLabels, AFewWrongLabelsDoNotShow) {
  OrientedPointCloud cloud = two_halves(2000);
  const OrientedPointCloud asked = test::torus_cloud(5000, 2);
  std::mt19937 random(3);
  for (int& label : cloud.labels) {
    if (random() % 10 == 0) label = random() % 2 == 0 ? -3 : 8;
  }
  const std::vector<int> labels = vote_labels(cloud, asked.points, asked.normals);
  int n_wrong = 0, n_far = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (std::abs(asked.points[i].x()) < .2) continue;  // some spacings from the border
    ++n_far;
    n_wrong += labels[i] != side(asked.points[i]);
  }
  EXPECT_LT(n_wrong, .005 * n_far);  // a single voter has 5 %
}

TEST(VoteLabels, TheOtherSideOfAThinSheetHasNoVote) {
  OrientedPointCloud cloud = test::plane_cloud(20, Vec3::UnitZ());
  const OrientedPointCloud top = cloud;
  cloud.labels.assign(cloud.points.size(), 1);
  // The lower side, four times as many samples and nearer to what is asked than the next sample of the upper one.
  for (const Vec3& x : test::plane_cloud(40, Vec3::UnitZ()).points) {
    cloud.points.push_back(x - 1e-3 * Vec3::UnitZ());
    cloud.normals.push_back(-Vec3::UnitZ());
    cloud.labels.push_back(2);
  }
  const std::vector<int> upper = vote_labels(cloud, top.points, top.normals);
  EXPECT_EQ(upper, std::vector<int>(top.points.size(), 1));
  const std::vector<Vec3> down(top.points.size(), -Vec3::UnitZ());
  EXPECT_EQ(vote_labels(cloud, top.points, down), std::vector<int>(top.points.size(), 2));
  const std::vector<Vec3> none(top.points.size(), Vec3::Zero());
  EXPECT_EQ(vote_labels(cloud, top.points, none).size(), top.points.size());
}

TEST(VoteLabels, CloudsWithoutLabelsAreRefused) {
  OrientedPointCloud cloud = two_halves(100);
  EXPECT_THROW(vote_labels(cloud, cloud.points, {}), std::invalid_argument);
  cloud.labels.pop_back();
  EXPECT_THROW(vote_labels(cloud, {}, {}), std::invalid_argument);
}

TEST(Clean, LabelsStayWithTheirPoints) {
  OrientedPointCloud cloud = two_halves(2000);
  cloud.points.insert(cloud.points.begin() + 7, Vec3(NAN, 0, 0));
  cloud.normals.insert(cloud.normals.begin() + 7, Vec3::UnitX());
  cloud.labels.insert(cloud.labels.begin() + 7, 5);
  for (int i = 0; i < 5; ++i) {
    cloud.points.push_back(cloud.points[static_cast<std::size_t>(i)]);
    cloud.normals.push_back(Vec3::UnitX());
    cloud.labels.push_back(5);
  }
  clean(cloud);
  ASSERT_EQ(cloud.labels.size(), cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) EXPECT_EQ(cloud.labels[i], side(cloud.points[i]));
  cloud.labels.pop_back();
  EXPECT_THROW(clean(cloud), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
