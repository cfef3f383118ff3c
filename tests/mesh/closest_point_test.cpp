#include "mesh/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/relaxation_direction.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

constexpr ClosestPointMethod kMethods[] = {ClosestPointMethod::Paper, ClosestPointMethod::Damped,
                                           ClosestPointMethod::Newton};

ClosestPointParams with(ClosestPointMethod method) {
  ClosestPointParams params;
  params.method = method;
  return params;
}

TEST(Domains, DerivativesAreThoseOfPsi) {
  const double e = 1e-5;  // second-order differences of functions of size 1: errors near 1e-9
  for (const AnalyticDomain& domain : testing::domains()) {
    for (int n = 0; n < 20; ++n) {
      const Vec3 x = domain.box.center() + .4 * domain.box.sizes().cwiseProduct(random_unit_vector(3, 0, n));
      for (int a = 0; a < 3; ++a) {
        const Vec3 d = e * Vec3::Unit(a);
        EXPECT_NEAR((domain.value(x + d) - domain.value(x - d)) / (2 * e), domain.gradient(x)[a], 1e-7) << domain.name;
        const Vec3 column = (domain.gradient(x + d) - domain.gradient(x - d)) / (2 * e);
        EXPECT_LT((column - domain.hessian(x).col(a)).norm(), 1e-6) << domain.name;
      }
    }
  }
}

TEST(ClosestPoint, StepIsMinusSignedDistance) {
  const AnalyticDomain ball = testing::sphere();
  for (const ClosestPointMethod method : kMethods) {
    for (int n = 0; n < 50; ++n) {
      const Vec3 normal = random_unit_vector(1, 0, n);
      const double phi = .2 * (n % 11 - 5) / 5.;
      const ClosestPoint foot = closest_point(ball, (1 + phi) * normal, .1, with(method));
      ASSERT_TRUE(foot.converged);
      EXPECT_NEAR(foot.t, -phi, 1e-8);
      EXPECT_LT((foot.point - normal).norm(), 1e-8);  // foot_tol * length
    }
  }
}

TEST(ClosestPoint, OffsettingABoundaryPointAlongItsNormalReturnsIt) {
  const double length = .08;
  for (const AnalyticDomain& domain : testing::domains()) {
    for (const ClosestPointMethod method : kMethods) {
      for (int n = 0; n < 40; ++n) {
        const Vec3 start = domain.boundary_seeds[n % domain.boundary_seeds.size()] + .1 * random_unit_vector(7, 1, n);
        const ClosestPoint on = closest_point(domain, start, length, with(ClosestPointMethod::Newton));
        if (!on.converged) continue;  // the seed may be deep inside
        const Vec3 normal = domain.gradient(on.point).normalized();
        const double offset = .05 * (n % 2 ? 1 : -1);
        const ClosestPoint foot = closest_point(domain, on.point + offset * normal, length, with(method));
        if (method == ClosestPointMethod::Paper && !foot.converged) continue;  // it may, where curvature is high
        ASSERT_TRUE(foot.converged) << domain.name << " " << n;
        EXPECT_LT(std::abs(domain.value(foot.point)) / domain.gradient(foot.point).norm(), 1e-10 * length)
            << domain.name;
        // The foot may only be another point if that is nearer.
        EXPECT_LE(std::abs(foot.t), .05 + 1e-7) << domain.name;
        const Vec3 to_x = on.point + offset * normal - foot.point;
        EXPECT_LT(to_x.cross(domain.gradient(foot.point).normalized()).norm(), 2e-7 * length) << domain.name;
      }
    }
  }
}

TEST(ClosestPoint, DampedAndNewtonReachWhereThePaperDiverges) {
  // Outside a thin ellipsoid's end the curvature is 1 / .09 and the distance .15: their product is well above one.
  const AnalyticDomain domain = testing::ellipsoid({1, .3, .3});
  const Vec3 x(1.15, .002, .001);
  EXPECT_FALSE(closest_point(domain, x, .1, with(ClosestPointMethod::Paper)).converged);
  for (const ClosestPointMethod method : {ClosestPointMethod::Damped, ClosestPointMethod::Newton}) {
    const ClosestPoint foot = closest_point(domain, x, .1, with(method));
    EXPECT_TRUE(foot.converged);
    EXPECT_NEAR(foot.t, -.15, 1e-3);
  }
}

TEST(ClosestPoint, NewtonTakesFewEvaluations) {
  const AnalyticDomain domain = testing::torus();
  const ClosestPoint foot = closest_point(domain, Vec3(1.45, .1, .03), .06, with(ClosestPointMethod::Newton));
  EXPECT_TRUE(foot.converged);
  EXPECT_LE(foot.iterations, 6);
}

TEST(ClosestPoint, WithoutHessianNewtonIsDamped) {
  struct NoHessian {
    AnalyticDomain domain = testing::torus();
    double value(const Vec3& x) const { return domain.value(x); }
    Vec3 gradient(const Vec3& x) const { return domain.gradient(x); }
  } psi;
  const Vec3 x(1.5, .1, .1);
  const ClosestPoint a = closest_point(psi, x, .1, with(ClosestPointMethod::Newton));
  const ClosestPoint b = closest_point(psi, x, .1, with(ClosestPointMethod::Damped));
  EXPECT_TRUE(a.converged);
  EXPECT_EQ(a.point, b.point);
}

TEST(ClosestPoint, SaysSoWhereThereIsNone) {
  const AnalyticDomain ball = testing::sphere();
  for (const ClosestPointMethod method : kMethods) {
    EXPECT_FALSE(closest_point(ball, Vec3::Zero(), .1, with(method)).converged);    // grad psi = 0
    EXPECT_FALSE(closest_point(ball, Vec3(9, 0, 0), .01, with(method)).converged);  // far beyond 10 lengths
  }
}

TEST(ClosestPoint, ProblemsNameEveryBrokenConstraint) {
  ClosestPointParams params;
  EXPECT_TRUE(problems(params).empty());
  params.max_iterations = 0;
  params.tol = -1;
  params.foot_tol = std::nan("");
  EXPECT_EQ(problems(params).size(), 3u);
}

}  // namespace
}  // namespace umtet
