#include "mesh/core/max_min.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/core/tet_quality.h"
#include "mesh/paper/relaxation_direction.h"

#ifdef UMTET_WITH_GSL
#include "mesh/core/polynomial_roots.h"
#endif

namespace umtet {
namespace {

/// A closed ring: the vertex at a point near the centre of a bumpy octahedral or icosahedral shell.
struct TestRing {
  Vec3 x;
  std::vector<Vec3> V;
  std::vector<Triangle> faces;
};

TestRing bumpy_octahedron(int seed) {
  TestRing ring;
  for (int a = 0; a < 3; ++a) {
    for (const double s : {1., -1.}) {
      const auto id = static_cast<std::int64_t>(ring.V.size());
      ring.V.push_back(s * Vec3::Unit(a) * (1 + .3 * random_unit_vector(seed, 1, id).x()) +
                       .25 * random_unit_vector(seed, 2, id));
    }
  }
  for (int k = 0; k < 8; ++k) {
    Triangle face = {k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2 & 1)};
    if (volume6(Vec3::Zero(), ring.V[face[0]], ring.V[face[1]], ring.V[face[2]]) < 0) std::swap(face[0], face[1]);
    ring.faces.push_back(face);
  }
  ring.x = .2 * random_unit_vector(seed, 3, 0);
  return ring;
}

double worst_quality(const TestRing& ring, const Vec3& x) {
  double q = 1;
  for (const Triangle& f : ring.faces) q = std::min(q, mean_ratio(x, ring.V[f[0]], ring.V[f[1]], ring.V[f[2]]));
  return q;
}

/// The rings of a family that are valid where their vertex is.
std::vector<TestRing> rings() {
  std::vector<TestRing> list;
  for (int seed = 0; seed < 400; ++seed) {
    TestRing ring = bumpy_octahedron(seed);
    if (worst_quality(ring, ring.x) > 0) list.push_back(std::move(ring));
  }
  return list;
}

TEST(OneRing, QualitiesAreThoseOfTheTets) {
  for (const TestRing& ring : rings()) {
    const OneRing one(ring.x, ring.V, ring.faces);
    for (int n = 0; n < 5; ++n) {
      const Vec3 y = .1 * n * random_unit_vector(9, 0, n);
      EXPECT_NEAR(quality_of(one.min_f(y)), worst_quality(ring, ring.x + y), 1e-12);
    }
  }
}

TEST(MaxMin, GoldenSectionNeverLowersTheQuality) {
  for (const TestRing& ring : rings()) {
    const Vec3 d = random_unit_vector(5, 0, 0);
    const MaxMinResult r = max_min(RingOnLine(OneRing(ring.x, ring.V, ring.faces), d), MaxMin::GoldenSection);
    EXPECT_GE(r.f, r.f_at_zero);
    EXPECT_NEAR(quality_of(r.f), worst_quality(ring, ring.x + r.lambda * d), 1e-12);
  }
}

#ifdef UMTET_WITH_GSL

TEST(MaxMin, ExactIsNotWorseThanGoldenSection) {
  const std::vector<TestRing> family = rings();
  ASSERT_GT(family.size(), 200u);
  int better = 0;
  for (const TestRing& ring : family) {
    for (int n = 0; n < 4; ++n) {
      const RingOnLine line(OneRing(ring.x, ring.V, ring.faces), random_unit_vector(6, 0, n));
      const MaxMinResult exact = max_min(line, MaxMin::Exact), golden = max_min(line, MaxMin::GoldenSection);
      EXPECT_GE(exact.f, golden.f * (1 - 1e-13));
      better += exact.f > golden.f * (1 + 1e-6);
    }
  }
  EXPECT_GT(better, 0);
}

TEST(MaxMin, ExactIsTheArgmax) {
  // The worst quality is quasi-concave along the line, so if it falls to both sides of lambda_opt that is its maximum.
  for (const TestRing& ring : rings()) {
    const Vec3 d = random_unit_vector(8, 0, 1);
    const MaxMinResult r = max_min(RingOnLine(OneRing(ring.x, ring.V, ring.faces), d), MaxMin::Exact);
    const double best = worst_quality(ring, ring.x + r.lambda * d);
    EXPECT_GE(best, worst_quality(ring, ring.x));
    for (const double step : {-1e-5, 1e-5, -1e-3, 1e-3, -.1, .1}) {
      // Near a smooth maximum 1e-5 costs about 1e-10, above the rounding of 1e-15.
      EXPECT_LT(worst_quality(ring, ring.x + (r.lambda + step) * d), best);
    }
  }
}

TEST(MaxMin, AnInvertedRingIsLeftAlone) {
  TestRing ring = bumpy_octahedron(0);
  ring.x = Vec3(3, 0, 0);
  const RingOnLine line(OneRing(ring.x, ring.V, ring.faces), Vec3::UnitX());
  EXPECT_EQ(max_min(line, MaxMin::Exact).lambda, 0);
  EXPECT_EQ(max_min(line, MaxMin::GoldenSection).lambda, 0);
}

std::vector<double> from_roots(const std::vector<double>& roots) {
  std::vector<double> c = {1};
  for (const double r : roots) {
    c.push_back(0);
    for (std::size_t k = c.size() - 1; k > 0; --k) c[k] = c[k - 1] - r * c[k];
    c[0] *= -r;
  }
  return c;
}

TEST(BracketedRoot, FindsTheChosenRoots) {
  for (int n = 0; n < 200; ++n) {
    std::vector<double> roots;
    for (int k = 0; k < 8; ++k) roots.push_back(random_unit_vector(11, n, k).x());
    std::sort(roots.begin(), roots.end());
    double gap = 2;
    for (int k = 1; k < 8; ++k) gap = std::min(gap, roots[k] - roots[k - 1]);
    if (gap < .03) continue;  // rounding of the coefficients moves closer roots
    const std::vector<double> c = from_roots(roots);
    for (int k = 1; k + 1 < 8; ++k) {
      const double lo = .5 * (roots[k - 1] + roots[k]), hi = .5 * (roots[k] + roots[k + 1]);
      EXPECT_NEAR(bracketed_root(c, lo, hi), roots[k], 1e-6);
    }
  }
}

TEST(BracketedRoot, WithoutASignChangeIsTheSmallerEnd) {
  const std::vector<double> c = {1, 0, 1};
  EXPECT_EQ(bracketed_root(c, .5, 2), .5);
  EXPECT_EQ(bracketed_root(std::vector<double>{-1, 1}, 1, 2), 1);  // the root is the end
}

#else

TEST(MaxMin, ExactNeedsGsl) {
  const TestRing ring = rings().front();
  const RingOnLine line(OneRing(ring.x, ring.V, ring.faces), Vec3::UnitX());
  EXPECT_THROW(max_min(line, MaxMin::Exact), std::logic_error);
}

#endif

}  // namespace
}  // namespace umtet
