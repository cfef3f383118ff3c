#include "reconstruct/winding/orient_by_winding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "tests/reconstruct/winding/winding_clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

using test::n_wrong, test::sorted, test::spread, test::thin_plate;
using Verdict = WindingReport::Verdict;

TEST(OrientByWinding, RightNormalsAreLeftAlone) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    OrientedPointCloud cloud = sorted(test::sampled(domain, 8000));
    const std::vector<Vec3> truth = cloud.normals;
    const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true});
    EXPECT_EQ(report.verdict, Verdict::Agrees) << domain.name;
    EXPECT_LT(report.off_before, 0.04) << domain.name;
    EXPECT_EQ(cloud.normals, truth) << domain.name;
  }
}

TEST(OrientByWinding, TurnsWhatIsWrongAndKeepsDirections) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(8000));
  const std::vector<Vec3> truth = cloud.normals;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (cloud.points[i].x() > 0.3) cloud.normals[i] = -truth[i];
  const WindingReport report = orient_by_winding(cloud, {});
  EXPECT_EQ(report.verdict, Verdict::Taken);
  EXPECT_TRUE(report.is_closed());
  EXPECT_GT(report.n_turned, 2000U);
  EXPECT_EQ(report.n_replaced, 0U);
  EXPECT_EQ(cloud.normals, truth);
}

/// Turns the samples around one point that are a share of all, at most.
std::size_t turn_a_part(OrientedPointCloud& cloud, double share) {
  const Vec3 at = cloud.points[cloud.points.size() / 2];
  std::vector<double> distance;
  for (const Vec3& x : cloud.points) distance.push_back((x - at).norm());
  std::vector<double> sorted = distance;
  std::sort(sorted.begin(), sorted.end());
  const double radius = sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size()))];
  std::size_t n = 0;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (distance[i] > radius) continue;
    cloud.normals[i] = -cloud.normals[i];
    ++n;
  }
  return n;
}

TEST(OrientByWinding, ASmallPartIsTurnedIfItsDirectionsAreEstimates) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(12000));
  const std::vector<Vec3> truth = cloud.normals;
  const std::size_t n = turn_a_part(cloud, .038);
  OrientedPointCloud given = cloud, refused = cloud;
  const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true});
  EXPECT_EQ(report.verdict, Verdict::Taken);
  EXPECT_EQ(report.n_turned, n);
  EXPECT_EQ(n_wrong(cloud.normals, truth), 0U);
  EXPECT_EQ(orient_by_winding(given, {}).verdict, Verdict::Agrees);

  // The splits that are compared differ in this part only.
  std::size_t n_different = 0;
  OrientByWinding how{.directions_may_change = true};
  how.explains_better = [&](const SplitCloud& former, const SplitCloud& proposed, bool is_certain) {
    EXPECT_TRUE(is_certain);
    for (std::size_t i = 0; i < former.known.normals.size(); ++i)
      n_different += former.known.normals[i] != proposed.known.normals[i] ? 1 : 0;
    return false;
  };
  EXPECT_EQ(orient_by_winding(refused, how).verdict, Verdict::NotBetter);
  EXPECT_GT(n_different, 0U);
  EXPECT_LT(n_different, 4000 * .06);
}

TEST(OrientByWinding, SparseCloudsWithoutNormalsComeOutRight) {
  for (const std::size_t n : {50, 200}) {
    OrientedPointCloud cloud = sorted(spread(test::torus_cloud(2000), n));
    const std::vector<Vec3> truth = cloud.normals;
    cloud.normals = estimate_normals(cloud.points).normals;
    orient_normals(cloud);
    orient_by_winding(cloud, {.directions_may_change = true});
    EXPECT_EQ(n_wrong(cloud.normals, truth), 0U) << n;
  }
}

TEST(OrientByWinding, ThinPlatesWithoutNormalsComeOutRight) {
  OrientedPointCloud cloud = sorted(thin_plate(0.1));
  const std::vector<Vec3> truth = cloud.normals;
  cloud.normals = estimate_normals(cloud.points).normals;
  orient_normals(cloud);
  orient_by_winding(cloud, {.directions_may_change = true});
  EXPECT_LE(n_wrong(cloud.normals, truth), truth.size() / 100);
}

TEST(OrientByWinding, SoDoThoseWithManySamples) {
  OrientedPointCloud cloud = sorted(test::box_cloud({4, 4, 0.05}, 0.05));
  const std::vector<Vec3> truth = cloud.normals;
  ASSERT_GT(truth.size(), 12000U);
  for (Vec3& n : cloud.normals)
    if (n.z() < 0) n = -n;  // as of a single sheet
  EXPECT_EQ(orient_by_winding(cloud, {.directions_may_change = true}).verdict, Verdict::Taken);
  EXPECT_LE(n_wrong(cloud.normals, truth), truth.size() / 100);
}

TEST(OrientByWinding, TakesOthersBackThatAreBetter) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(8000));
  const std::vector<Vec3> truth = cloud.normals;
  for (std::size_t i = 0; i < truth.size(); i += 2) cloud.normals[i] = -truth[i];
  const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true, .others = &truth});
  EXPECT_TRUE(report.restored);
  EXPECT_EQ(report.verdict, Verdict::Agrees);
  EXPECT_EQ(cloud.normals, truth);
  const std::vector<Vec3> few(3, Vec3::UnitX());
  cloud.normals.assign(truth.size(), Vec3::UnitX());
  EXPECT_THROW(orient_by_winding(cloud, {.directions_may_change = true, .others = &few}), std::invalid_argument);
}

TEST(OrientByWinding, ZeroNormalsStay) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(2000));
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) cloud.normals[i] *= i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : -1;
  orient_by_winding(cloud, {.directions_may_change = true});
  for (std::size_t i = 0; i < cloud.normals.size(); i += 3) EXPECT_TRUE(cloud.normals[i].isZero(0));
}

/// As the cloud stage has it: samples without normals, those that neighbours agree on, and the truth.
struct Propagated {
  OrientedPointCloud cloud;
  std::vector<Vec3> truth;
  explicit Propagated(OrientedPointCloud given) : cloud(sorted(std::move(given))), truth(cloud.normals) {
    cloud.normals = estimate_normals(cloud.points).normals;
    orient_normals(cloud);
  }
};

TEST(OrientByWinding, NoiseIsNoReasonToTurnNormalsThatAgree) {
  constexpr double kSpacing = .063;  // of 4000 points of the torus
  for (const double spacings : {.5, 1., 1.7}) {
    for (const std::uint64_t seed : {1, 2}) {
      Propagated it(test::with_noise(test::torus_cloud(4000, seed), spacings * kSpacing, seed));
      const std::vector<Vec3> before = it.cloud.normals;
      EXPECT_EQ(orient_by_winding(it.cloud, {.directions_may_change = true}).n_turned, 0U) << spacings << ' ' << seed;
      EXPECT_EQ(it.cloud.normals, before) << spacings << ' ' << seed;
      EXPECT_LT(n_wrong(it.cloud.normals, it.truth), 40U) << spacings << ' ' << seed;
    }
  }
}

TEST(OrientByWinding, TurnsAPatchOfANoisyCloud) {
  OrientedPointCloud cloud = sorted(test::with_noise(test::torus_cloud(8000), .02));
  const std::vector<Vec3> truth = cloud.normals;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (cloud.points[i].x() > .9) cloud.normals[i] = -truth[i];
  const std::size_t before = n_wrong(cloud.normals, truth);
  const WindingReport report = orient_by_winding(cloud, {});
  EXPECT_EQ(report.verdict, Verdict::Taken);
  EXPECT_GE(report.consistency_tried, report.consistency_before);
  EXPECT_LT(report.off_tried, report.off_before);
  EXPECT_LT(n_wrong(cloud.normals, truth), before / 10);
}

TEST(OrientByWinding, NormalsThatFollowNoiseAreUncertain) {
  // Half of the sides are wrong, but what the winding number has instead turns every third sample.
  OrientedPointCloud cloud = Propagated(test::with_noise(test::torus_cloud(4000), 1.7 * .063)).cloud;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i)
    if (cloud.points[i].x() > 0) cloud.normals[i] = -cloud.normals[i];
  const std::vector<Vec3> before = cloud.normals;
  const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true});
  EXPECT_EQ(report.verdict, Verdict::Uncertain);
  EXPECT_LT(report.consistency_tried, report.consistency_before);
  EXPECT_EQ(cloud.normals, before);
}

TEST(OrientByWinding, WhereItIsNotCertainTheFitDecides) {
  const OrientedPointCloud given = [] {
    OrientedPointCloud cloud = Propagated(test::with_noise(test::torus_cloud(4000), 1.7 * .063)).cloud;
    for (std::size_t i = 0; i < cloud.normals.size(); ++i)
      if (cloud.points[i].x() > 0) cloud.normals[i] = -cloud.normals[i];
    return cloud;
  }();
  for (const bool is_better : {false, true}) {
    const auto judge = [&](const SplitCloud&, const SplitCloud&, bool is_certain) {
      EXPECT_FALSE(is_certain);
      return is_better;
    };
    OrientedPointCloud cloud = given;
    const WindingReport report = orient_by_winding(cloud, {.directions_may_change = true, .explains_better = judge});
    EXPECT_EQ(report.verdict, is_better ? Verdict::Taken : Verdict::Uncertain);
    EXPECT_EQ(cloud.normals == given.normals, !is_better);
  }
}

TEST(OrientByWinding, HeldOutSamplesDecide) {
  OrientedPointCloud cloud = sorted(test::torus_cloud(8000));
  const std::vector<Vec3> truth = cloud.normals;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (cloud.points[i].x() > 0.3) cloud.normals[i] = -truth[i];
  const std::vector<Vec3> before = cloud.normals;
  for (const bool is_better : {false, true}) {
    const auto judge = [&](const SplitCloud& former, const SplitCloud& proposed, bool is_certain) {
      EXPECT_TRUE(is_certain);
      EXPECT_EQ(former.known.points, proposed.known.points);
      EXPECT_EQ(former.held_out.points, proposed.held_out.points);
      EXPECT_GT(former.held_out.points.size(), 1000U);
      for (const Vec3& x : former.held_out.points)
        EXPECT_EQ(std::count(former.known.points.begin(), former.known.points.end(), x), 0);
      EXPECT_NE(former.held_out.normals, proposed.held_out.normals);
      return is_better;
    };
    const WindingReport report = orient_by_winding(cloud, {.explains_better = judge});
    EXPECT_EQ(report.verdict, is_better ? Verdict::Taken : Verdict::NotBetter);
    EXPECT_EQ(cloud.normals, is_better ? truth : before);
  }
}

}  // namespace
}  // namespace umtet
