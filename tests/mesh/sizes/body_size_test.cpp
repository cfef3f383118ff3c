#include "mesh/sizes/body_size.h"

#include <gtest/gtest.h>

#include <atomic>

#include "mesh/submesh/submesh.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

TEST(ExpectedTets, IsNearTheCountAlsoInABoxMuchTooLarge) {
  const AnalyticDomain ball = testing::sphere();
  const Box large(Vec3::Constant(-12), Vec3::Constant(14));
  const double h = h_for_tets(ball, large, 20000);
  const auto n = static_cast<double>(find_submesh(BackgroundMesh(a15(), ball.box, h), ball).mesh.C.size());
  EXPECT_NEAR(n, 20000, 2000);
  EXPECT_NEAR(expected_tets(ball, large, h), 20000, 1);
  EXPECT_EQ(expected_tets(ball, Box(Vec3::Constant(5), Vec3::Constant(6)), h), 0);
}

TEST(ExpectedTets, ChosenLabelsTakeFewer) {
  for (const AnalyticDomain& domain : {testing::sphere(), testing::torus(), testing::banchoff_chmutov_4()}) {
    SCOPED_TRACE(domain.name);
    constexpr double kAsked = 20000;
    const double h = h_for_tets(domain, domain.box, kAsked, ClassificationSource::Chosen);
    const UmResult result = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain);
    ASSERT_EQ(result.status, UmStatus::Success) << result.evidence.what;
    EXPECT_NEAR(static_cast<double>(result.submesh.mesh.C.size()), kAsked, .07 * kAsked);
    const BodySize size = body_size(domain, domain.box);
    EXPECT_NEAR(expected_tets(a15(), size, h, ClassificationSource::Chosen), kAsked, 1);
    EXPECT_GT(expected_tets(a15(), size, h, ClassificationSource::Psi), 1.07 * kAsked);
  }
}

TEST(BodySize, WithABoundOfTheGradientIsTheSameForFewerValues) {
  struct Counted {
    const AnalyticDomain& domain;
    mutable std::atomic<int> n = 0;
    double value(const Vec3& x) const { return ++n, domain.value(x); }
    Vec3 gradient(const Vec3& x) const { return domain.gradient(x); }
  };
  const AnalyticDomain ball = testing::sphere();
  const double steepest = ball.gradient(ball.box.max()).norm();
  const Counted all{ball}, some{ball};
  const BodySize size = body_size(all, ball.box), same = body_size(some, ball.box, steepest);
  EXPECT_EQ(same.volume, size.volume);
  EXPECT_EQ(same.area, size.area);
  EXPECT_LT(some.n, all.n / 2);
}

}  // namespace
}  // namespace umtet
