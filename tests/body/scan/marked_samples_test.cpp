// Samples that the preparation of a scan drops, turns or doubts are named with their positions.

#include <gtest/gtest.h>

#include <algorithm>

#include "body/scan/cloud_preparation.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

PreparedCloud prepared(OrientedPointCloud cloud, const BodyOptions& options = {}) {
  return prepare_cloud({std::move(cloud), {}}, "test", options);
}

std::vector<Vec3> with_mark(const PreparedCloud& cloud, SampleMark mark) {
  std::vector<Vec3> points;
  for (const MarkedSample& sample : cloud.marked)
    if (sample.mark == mark) points.push_back(sample.where);
  return points;
}

TEST(MarkedSamples, AreNoneInACleanCloud) { EXPECT_TRUE(prepared(test::torus_cloud(5000)).marked.empty()); }

TEST(MarkedSamples, AreTheDroppedOnes) {
  OrientedPointCloud cloud = test::with_outliers(test::torus_cloud(10000), 50);
  test::add_sphere(cloud, {0, 0, 0}, 0.05, 60);
  const std::vector<Vec3> all = cloud.points;
  const PreparedCloud made = prepared(cloud);
  const std::vector<Vec3> outliers = with_mark(made, SampleMark::Outlier),
                          small = with_mark(made, SampleMark::SmallComponent);
  EXPECT_EQ(outliers.size(), made.report.dropped.outliers);
  EXPECT_GT(outliers.size(), 20U);
  EXPECT_EQ(small.size(), made.report.dropped.small_components);
  for (const Vec3& x : outliers) {
    EXPECT_NE(std::find(all.begin(), all.end(), x), all.end());
    EXPECT_EQ(std::find(made.cloud.points.begin(), made.cloud.points.end(), x), made.cloud.points.end());
  }
  for (const Vec3& x : small) EXPECT_NEAR(x.norm(), .05, 1e-9);
}

TEST(MarkedSamples, AreThoseWhoseNormalsWereTurned) {
  OrientedPointCloud cloud = test::torus_cloud(8000);
  for (Vec3& x : cloud.points) x += Vec3(1e6, 0, 0);  // marks are in the coordinates of the input, too
  std::vector<Vec3> wrong;
  for (std::size_t i = 0; i < cloud.points.size(); i += 9) {
    cloud.normals[i] = -cloud.normals[i];
    wrong.push_back(cloud.points[i]);
  }
  const PreparedCloud made = prepared(cloud);
  std::vector<Vec3> turned = with_mark(made, SampleMark::Turned);
  EXPECT_EQ(turned.size(), made.report.normals.orientation->n_turned);
  const auto by_place = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(turned.begin(), turned.end(), by_place);
  std::sort(wrong.begin(), wrong.end(), by_place);
  ASSERT_EQ(turned.size(), wrong.size());
  for (std::size_t i = 0; i < wrong.size(); ++i) EXPECT_LT((turned[i] - wrong[i]).norm(), 1e-9 * 1e6);
  BodyOptions given;
  given.scan.normals = NormalsOf::Given;
  EXPECT_TRUE(prepared(cloud, given).marked.empty());
}

TEST(MarkedSamples, AreThoseWhoseSideIsAGuess) {
  OrientedPointCloud sheet;  // open and flat: neither side is outside
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) sheet.points.emplace_back(.02 * i + .001 * (j % 3), .02 * j, 0);
  const PreparedCloud made = prepared(sheet);
  const std::vector<Vec3> doubtful = with_mark(made, SampleMark::Doubtful);
  EXPECT_EQ(doubtful.size(), made.report.normals.orientation->n_doubtful);
  EXPECT_EQ(doubtful.size(), made.cloud.points.size());
}

}  // namespace
}  // namespace umtet
