// Sizes on surfaces whose thickness and curvature are known.

#include "mesh/sizes/surface_sizes.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>

#include "mesh/implicit/zero_set.h"
#include "mesh/sizes/size_field.h"
#include "tests/support/domains.h"

using namespace umtet;
using namespace umtet::testing;

namespace {

/// Sources of a domain from the cut points of a grid.
std::vector<SizeSource> sizes_of(const AnalyticDomain& domain, double spacing, const SurfaceSizeParams& params) {
  const ZeroSetTopology zero = zero_set_topology(domain, domain.box, spacing);
  return surface_sizes(domain, zero.cut_points, spacing, params);
}

/// The ellipsoid |x|^2 + |y|^2 + (z / c)^2 = 1.
AnalyticDomain lens(double c) { return ellipsoid({1, 1, c}); }

}  // namespace

TEST(SurfaceSizes, OfABodyThatIsThickAndSmoothAreThoseAskedFor) {
  const auto sources = sizes_of(sphere(), .1, {.h = .2, .h_min = .01});
  ASSERT_GT(sources.size(), 100u);
  for (const SizeSource& s : sources) {
    EXPECT_EQ(s.h, .2);
    EXPECT_NEAR(s.x.norm(), 1, 1e-4);
  }
}

TEST(SurfaceSizes, LieOnPsiAndAreNoFartherApartThanTheyAreLarge) {
  const AnalyticDomain body = lens(.1);
  const auto sources = sizes_of(body, .05, {.h = .1, .h_min = .004});
  for (const SizeSource& s : sources) EXPECT_NEAR(body.value(s.x) / body.gradient(s.x).norm(), 0, 1e-5);
  // What is asked for at any point of the surface is what is asked for nearby.
  const SizeField field(sources, {.grade = .3, .h_min = .004, .h_max = 1});
  const std::vector<Vec3> points = zero_set_topology(body, body.box, .023).cut_points;
  for (std::size_t i = 0; i < points.size(); i += 10) {
    const Vec3& x = points[i];
    double nearest = 1e9;
    for (const SizeSource& s : sources) nearest = std::min(nearest, (s.x - x).norm() - s.radius);
    EXPECT_LE(nearest, 0) << x.transpose();
    EXPECT_LE(field.at(x), .1 * 1.05);
  }
}

TEST(SurfaceSizes, EndWhereSomeAreEnough) {
  const AnalyticDomain body = lens(.1);
  const std::vector<Vec3> points = zero_set_topology(body, body.box, .05).cut_points;
  const SurfaceSizeParams params{.h = .1, .h_min = .004};
  const std::vector<SizeSource> all = surface_sizes(body, points, .05, params);
  std::vector<std::size_t> asked;
  const auto ends_at = [&](std::size_t n) {
    asked.clear();
    return surface_sizes(body, points, .05, params, {}, [&](const std::vector<SizeSource>& sources) {
      asked.push_back(sources.size());
      return sources.size() >= n;
    });
  };
  const std::vector<SizeSource> first = ends_at(1);
  ASSERT_EQ(asked.size(), 1u);
  EXPECT_EQ(first.size(), asked.front());
  EXPECT_LT(2 * first.size(), all.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].x, all[i].x);
  EXPECT_EQ(ends_at(all.size() + 1).size(), all.size());
}

TEST(SurfaceSizes, PutEnoughEdgesAcrossAThinBody) {
  // t = 2 c sqrt(1 - x^2 - y^2) along z, a little less along the normal.
  const double c = .05;
  const auto sources = sizes_of(lens(c), .05, {.h = .1, .h_min = .004, .max_turn = 0});
  for (const SizeSource& s : sources) {
    const double r = std::hypot(s.x.x(), s.x.y());
    if (r > .8) continue;
    const double t = 2 * c * std::sqrt(1 - r * r);
    EXPECT_NEAR(s.h, t / 2.2, .05 * t) << s.x.transpose();
  }
}

TEST(SurfaceSizes, LeaveOutTheThicknessToASheetThatIsNotKnown) {
  SurfaceSizeParams params{.h = .1, .h_min = .004, .max_turn = 0};
  params.is_known = [](const Vec3&, const Vec3& gradient) { return gradient.z() > 0; };
  for (const SizeSource& s : sizes_of(lens(.05), .05, params))
    if (std::hypot(s.x.x(), s.x.y()) < .8) EXPECT_EQ(s.h, .1) << s.x.transpose();
}

TEST(SurfaceSizes, PutEnoughEdgesAcrossAGap) {
  AnalyticDomain two = sphere();  // spheres of radius .5 with a gap of .06
  two.psi = [](const Vec3& x, Vec3* g, Mat3* H) {
    const Vec3 d = x - Vec3(x.x() > 0 ? .53 : -.53, 0, 0);
    if (g) *g = 2 * d;
    if (H) *H = 2 * Mat3::Identity();
    return d.squaredNorm() - .25;
  };
  double least = 1;
  for (const SizeSource& s : sizes_of(two, .05, {.h = .1, .h_min = .004, .max_turn = 0})) least = std::min(least, s.h);
  EXPECT_NEAR(least, .06 / 2.2, .003);
}

TEST(SurfaceSizes, AreNotBelowTheFloor) {
  for (const SizeSource& s : sizes_of(lens(.002), .05, {.h = .1, .h_min = .02})) EXPECT_GE(s.h, .02);
}

TEST(SurfaceSizes, FollowTheTurnOfTheNormal) {
  // Of a torus, whose section has the radius .1; the other curvature is at most 1 / .9.
  const auto sources = sizes_of(torus(1, .1), .05, {.h = .1, .h_min = .01, .edges_across = 0, .max_turn = .5});
  for (const SizeSource& s : sources) EXPECT_NEAR(s.h, .5 * .1, .006);
}

TEST(SurfaceSizes, DoNotFollowTurnsWithinTheNoise) {
  // An arc of h on a radius R is h^2 / 8 R from its chord.
  const double R = .1, noise = .002;
  const auto sources =
      sizes_of(torus(1, R), .05, {.h = .06, .h_min = .01, .edges_across = 0, .max_turn = .2, .noise = noise});
  for (const SizeSource& s : sources) EXPECT_NEAR(s.h, std::sqrt(8 * R * noise), .003);
}

TEST(SurfaceSizes, DoNotFollowASharpEdgeWithoutEnd) {
  const auto cube = [](const Vec3& x, Vec3* g, Mat3*) {
    Eigen::Index axis = 0;
    const double value = x.cwiseAbs().maxCoeff(&axis);
    if (g) *g = Vec3::Unit(axis) * (x[axis] > 0 ? 1 : -1);
    return value - .8;
  };
  double least = 1;
  for (const SizeSource& s : sizes_of({"cube", cube_box(1), 1, 0, {}, {}, cube}, .05, {.h = .2, .h_min = .001})) {
    least = std::min(least, s.h);
  }
  EXPECT_NEAR(least, .5 * .2, 1e-12);
}

TEST(SurfaceSizes, KeepFlatFacesNear) {
  // Of a sphere, k1 = k2 = 1: h = sqrt(3.4 deviation).
  for (const SizeSource& s : sizes_of(sphere(), .1, {.h = .5, .h_min = .01, .deviation = .001})) {
    EXPECT_NEAR(s.h, std::sqrt(3.4 * .001), 1e-6);
  }
}

TEST(SurfaceSizes, AreTheSameForEveryNumberOfThreads) {
  const auto make = [&](std::size_t n_threads) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    return sizes_of(lens(.08), .05, {.h = .1, .h_min = .004});
  };
  const auto one = make(1), four = make(4);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].x, four[i].x);
    EXPECT_EQ(one[i].h, four[i].h);
  }
}

TEST(SurfaceSizes, ListEveryFault) {
  try {
    surface_sizes(sphere(), {}, 0, {.h = -1, .h_min = 0, .edges_across = -1});
    FAIL();
  } catch (const std::invalid_argument& e) {
    const std::string what = e.what();
    for (const char* word : {"h_min", "h =", "edges_across", "spacing"}) EXPECT_NE(what.find(word), what.npos) << what;
  }
}
