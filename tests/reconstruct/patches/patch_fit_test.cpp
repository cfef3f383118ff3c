#include "reconstruct/patches/patch_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

namespace umtet {
namespace {

/// Samples of the graph-like part |(x, y)| < 12 of a surface, about a spacing of 1 apart, and points of it up to
/// `beyond` outside of that disc.
struct Surface {
  std::function<Vec3(double, double)> point, normal;
};

constexpr double kPi = 3.141592653589793;

Surface plane() {
  return {[](double x, double y) { return Vec3(x, y, .3 * x); },
          [](double, double) { return Vec3(-.3, 0, 1).normalized(); }};
}
/// A ball of radius R below.
Surface ball(double R) {
  const auto point = [R](double x, double y) -> Vec3 { return Vec3(x, y, std::sqrt(R * R - x * x - y * y) - R); };
  return {point, [=](double x, double y) -> Vec3 { return (point(x, y) + Vec3(0, 0, R)).normalized(); }};
}
Surface pipe(double R) {
  return {[R](double x, double y) { return Vec3(R * std::sin(x / R), y, R * std::cos(x / R)); },
          [R](double x, double) { return Vec3(std::sin(x / R), 0, std::cos(x / R)); }};
}
/// The outer part of a torus of radii R and r.
Surface torus(double R, double r) {
  const auto normal = [=](double x, double y) -> Vec3 {
    return Vec3(std::cos(y / r) * std::sin(x / (R + r)), std::sin(y / r), std::cos(y / r) * std::cos(x / (R + r)));
  };
  return {[=](double x, double y) -> Vec3 {
            return Vec3(R * std::sin(x / (R + r)), 0, R * std::cos(x / (R + r))) + r * normal(x, y);
          },
          normal};
}

PatchSamples samples(const Surface& surface, double noise, double tilt_deg, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> unit(-.35, .35);
  PatchSamples made;
  made.spacing = 1;
  made.noise = noise;
  const auto vector = [&] { return Vec3(gauss(random), gauss(random), gauss(random)); };
  for (int i = -12; i <= 12; ++i)
    for (int j = -12; j <= 12; ++j) {
      const double x = i + unit(random), y = j + unit(random);
      if (std::hypot(x, y) > 12) continue;
      made.points.push_back(surface.point(x, y) + noise * vector());
      made.normals.push_back(
          (surface.normal(x, y) + std::tan(tilt_deg * kPi / 180) / std::sqrt(2.) * vector()).normalized());
    }
  return made;
}

/// Root mean square distance of the zero set from the surface along a circle.
double error_at(const PatchFit& fit, const Surface& surface, double radius) {
  double sum = 0;
  constexpr int n = 60;
  for (int k = 0; k < n; ++k) {
    const double a = 2 * kPi * k / n;
    Vec3 g;
    const double f = fit.evaluate(surface.point(radius * std::cos(a), radius * std::sin(a)), &g, nullptr);
    sum += f * f / g.squaredNorm();
  }
  return std::sqrt(sum / n);
}

TEST(PatchFit, QuadricsGoOnBeyondTheirSamples) {
  struct Case {
    Surface surface;
    PatchFit::Kind kind;
  };
  for (const Case& c : {Case{plane(), PatchFit::Kind::Plane}, Case{ball(20), PatchFit::Kind::Quadric},
                        Case{pipe(8), PatchFit::Kind::Quadric}}) {
    const PatchFit exact(samples(c.surface, 0, 0, 1));
    EXPECT_EQ(exact.kind(), c.kind);
    EXPECT_LE(error_at(exact, c.surface, 14), 2e-4);
    const PatchFit noisy(samples(c.surface, .2, 10, 1));
    EXPECT_EQ(noisy.kind(), c.kind);
    EXPECT_LE(error_at(noisy, c.surface, 13), .12);
    EXPECT_NEAR(noisy.residual(), .2, .03);
  }
}

TEST(PatchFit, SplinesGoOnBeyondTheSamplesOfATorus) {
  const Surface surface = torus(12, 6);
  const PatchFit exact(samples(surface, 0, 0, 1)), noisy(samples(surface, .1, 5, 1));
  EXPECT_EQ(exact.kind(), PatchFit::Kind::Splines);
  EXPECT_LE(error_at(exact, surface, 8), .01);
  EXPECT_LE(error_at(exact, surface, 12.7), .04);
  EXPECT_LE(error_at(noisy, surface, 12.7), .1);
}

TEST(PatchFit, NoiseDoesNotMakeAPlaneCurved) {
  for (const double noise : {0., .05, .3}) {
    int n_planes = 0;
    for (unsigned seed = 0; seed < 20; ++seed)
      n_planes += PatchFit(samples(plane(), noise, 100 * noise / 2, seed)).kind() == PatchFit::Kind::Plane ? 1 : 0;
    EXPECT_GE(n_planes, 19) << noise;
  }
}

TEST(PatchFit, DerivativesAreThoseOfTheValues) {
  for (const Surface& surface : {ball(20), torus(12, 6)}) {
    const PatchFit fit(samples(surface, .05, 5, 2));
    for (const double height : {-.5, .4, 40.}) {  // in the band, and far beyond it
      const Vec3 x = surface.point(3, 2) + height * surface.normal(3, 2);
      Vec3 g;
      Mat3 H;
      fit.evaluate(x, &g, &H);
      constexpr double d = 1e-4;
      for (int k = 0; k < 3; ++k) {
        const Vec3 step = d * Vec3::Unit(k);
        Vec3 up, down;
        const double difference = fit.evaluate(x + step, &up, nullptr) - fit.evaluate(x - step, &down, nullptr);
        EXPECT_NEAR(difference / (2 * d), g[k], 1e-5);
        EXPECT_LE(((up - down) / (2 * d) - H.col(k)).norm(), 1e-4);
      }
    }
  }
}

TEST(PatchFit, TheScaleDoesNotMatter) {
  const Surface surface = torus(12, 6);
  PatchSamples one = samples(surface, .1, 5, 3), other = one;
  for (Vec3& x : other.points) x = 1e-3 * x + Vec3(1, 2, 3);
  other.spacing *= 1e-3, other.noise *= 1e-3;
  const PatchFit a(one), b(other);
  EXPECT_EQ(a.weight(), b.weight());
  const Vec3 x = surface.point(2, 3) + .3 * surface.normal(2, 3);
  EXPECT_NEAR(b.evaluate(1e-3 * x + Vec3(1, 2, 3), nullptr, nullptr), 1e-3 * a.evaluate(x, nullptr, nullptr),
              1e-3 * 1e-2);
}

TEST(PatchFit, AFewSamplesFarAwayDoNotMatter) {
  PatchSamples some = samples(plane(), .05, 5, 4);
  const PatchFit clean(some);
  for (int k = 0; k < 4; ++k) {
    some.points.emplace_back(k, 2 * k, 5 + k);
    some.normals.emplace_back(1, 0, 0);
  }
  const PatchFit fit(some);
  EXPECT_EQ(fit.kind(), PatchFit::Kind::Plane);
  EXPECT_LE(error_at(fit, plane(), 12), .05);
}

TEST(PatchFit, FewSamplesAreAPlane) {
  PatchSamples some;
  some.spacing = 1;
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
    some.points.push_back(x);
    some.normals.emplace_back(0, 0, 1);
  }
  EXPECT_NEAR(PatchFit(some).evaluate(Vec3(5, 5, 2), nullptr, nullptr), 2, 1e-12);
  EXPECT_THROW(PatchFit{PatchSamples{}}, std::invalid_argument);
}

}  // namespace
}  // namespace umtet
