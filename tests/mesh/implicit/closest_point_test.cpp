#include "mesh/implicit/closest_point.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "mesh/paper/relaxation_direction.h"
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

/// The n-th of some points of the boundary, by bisection between a point inside and one outside.
Vec3 boundary_point(const AnalyticDomain& domain, int n) {
  Vec3 inside = Vec3::Zero(), outside = Vec3::Zero();
  bool has_inside = false, has_outside = false;
  for (int k = 0; !has_inside || !has_outside; ++k) {
    const Vec3 x = domain.box.center() + .6 * domain.box.sizes().cwiseProduct(random_unit_vector(7, n, k));
    if (!domain.box.contains(x)) continue;
    const Vec3 y = domain.box.center() + (k % 8 + 1) / 8. * (x - domain.box.center());
    (domain.value(y) < 0 ? inside : outside) = y;
    (domain.value(y) < 0 ? has_inside : has_outside) = true;
  }
  for (int halving = 0; halving < 60; ++halving) {
    const Vec3 middle = .5 * (inside + outside);
    (domain.value(middle) < 0 ? inside : outside) = middle;
  }
  return inside;
}

TEST(ClosestPoint, OffsettingABoundaryPointAlongItsNormalReturnsIt) {
  const double length = .08;
  for (const AnalyticDomain& domain : testing::domains()) {
    for (const ClosestPointMethod method : kMethods) {
      for (int n = 0; n < 40; ++n) {
        const Vec3 on = boundary_point(domain, n);
        const Vec3 normal = domain.gradient(on).normalized();
        const double offset = .05 * (n % 2 ? 1 : -1);
        const ClosestPoint foot = closest_point(domain, on + offset * normal, length, with(method));
        ASSERT_TRUE(foot.converged) << domain.name << " " << n;
        EXPECT_LT(std::abs(domain.value(foot.point)) / domain.gradient(foot.point).norm(), 1e-10 * length)
            << domain.name;
        // The foot may only be another point if that is nearer.
        EXPECT_LE(std::abs(foot.t), .05 + 1e-7) << domain.name;
        const Vec3 to_x = on + offset * normal - foot.point;
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

/// A point at `focal` times the distance, inwards, at which the greater principal curvature of the surface brings
/// neighbouring normals together: beyond 1 the boundary point it came from is no local minimum of the distance.
Vec3 near_focal_surface(const AnalyticDomain& domain, const Vec3& on, double focal) {
  const Vec3 g = domain.gradient(on), w = g.normalized(), e1 = w.unitOrthogonal(), e2 = w.cross(e1);
  const Mat3 H = domain.hessian(on) / g.norm();
  const double a = e1.dot(H * e1), b = e1.dot(H * e2), d = e2.dot(H * e2);
  const double curvature = .5 * (a + d) + std::hypot(.5 * (a - d), b);
  return on - focal / curvature * w;
}

/// On psi = 0, and no point of the surface around is nearer to x.
void expect_local_minimum(const AnalyticDomain& domain, const Vec3& x, const ClosestPoint& foot, double length) {
  const Vec3 g = domain.gradient(foot.point), w = g.normalized(), e1 = w.unitOrthogonal(), e2 = w.cross(e1);
  ASSERT_LE(std::abs(domain.value(foot.point)) / g.norm(), 1e-10 * length);
  const double radius = .02;
  for (int k = 0; k < 16; ++k) {
    const double angle = k * (std::numbers::pi / 8);
    Vec3 y = foot.point + radius * (std::cos(angle) * e1 + std::sin(angle) * e2);
    for (int it = 0; it < 20; ++it) {
      const Vec3 gy = domain.gradient(y);
      y -= domain.value(y) / gy.squaredNorm() * gy;
    }
    ASSERT_LT(std::abs(domain.value(y)), 1e-12);
    // What is left of the slide, foot_tol * length, costs no more than its product with the radius over the distance.
    ASSERT_GE((x - y).norm(), (x - foot.point).norm() - 1e-7 * length * radius / (x - foot.point).norm());
  }
}

TEST(ClosestPoint, NewtonIsALocalMinimumNearTheFocalSurface) {
  const Vec3 axes(1, .8, .6);
  const AnalyticDomain domain = testing::ellipsoid(axes);
  int n_paper_fails = 0;
  for (const double focal : {.9, .95, 1.1, 1.5}) {
    for (int n = 0; n < 100; ++n) {
      const Vec3 x = near_focal_surface(domain, axes.cwiseProduct(random_unit_vector(5, 0, n)), focal);
      const ClosestPoint foot = closest_point(domain, x, .2, with(ClosestPointMethod::Newton));
      ASSERT_TRUE(foot.converged) << focal << " " << n;
      expect_local_minimum(domain, x, foot, .2);
      n_paper_fails += !closest_point(domain, x, .2, with(ClosestPointMethod::Paper)).converged;
    }
  }
  EXPECT_GT(n_paper_fails, 50);
}

TEST(ClosestPoint, LineSearchSettlesWhereTheIterationGivesUp) {
  const Vec3 axes(1, .5, .2);
  const AnalyticDomain domain = testing::ellipsoid(axes);
  const double length = .1;
  int n_searched = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 x = near_focal_surface(domain, axes.cwiseProduct(random_unit_vector(5, 0, n)), .95);
    ClosestPointParams params = with(ClosestPointMethod::Damped);
    params.max_distance = 100;  // the flat sides of the ellipsoid are several units from their focal points
    const ClosestPoint foot = closest_point(domain, x, length, params);
    if (!foot.converged || foot.iterations <= params.max_iterations) continue;
    ++n_searched;
    expect_local_minimum(domain, x, foot, length);
    params.method = ClosestPointMethod::Paper;
    EXPECT_FALSE(closest_point(domain, x, length, params).converged) << n;
  }
  EXPECT_GE(n_searched, 5);
}

TEST(ClosestPoint, LineSearchFindsTheFootOfTheIteration) {
  const AnalyticDomain domain = testing::ellipsoid();
  for (int n = 0; n < 100; ++n) {
    const Vec3 on = Vec3(1, .8, .6).cwiseProduct(random_unit_vector(5, 0, n));
    const Vec3 x = near_focal_surface(domain, on, .3);
    ClosestPointParams params = with(ClosestPointMethod::Newton);
    const ClosestPoint iterated = closest_point(domain, x, .2, params);
    ASSERT_LE(iterated.iterations, params.max_iterations);
    params.max_iterations = 3;  // too few, so the search begins with ten times as many
    const ClosestPoint searched = closest_point(domain, x, .2, params);
    ASSERT_GT(searched.iterations, params.max_iterations);
    ASSERT_TRUE(searched.converged) << n;
    EXPECT_LT((searched.point - iterated.point).norm(), 1e-6 * .2) << n;  // two feet, each to foot_tol over 1 - .3
    EXPECT_LT((searched.point - on).norm(), 1e-6 * .2) << n;
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
