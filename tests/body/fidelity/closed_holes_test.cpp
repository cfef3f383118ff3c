#include "body/fidelity/closed_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "body/pieces/zero_set_choice.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

using std::numbers::pi;

/// The unit sphere in 20,480 faces of edge .035.
struct Sphere {
  std::vector<Triangle> faces;
  std::vector<Vec3> V = testing::sphere_surface(5, faces).V;
};

/// n points of the unit sphere, about as far from one another as can be.
std::vector<Vec3> even_samples(int n) {
  std::vector<Vec3> x;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.) / n, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    x.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  return x;
}

std::vector<Vec3> random_samples(int n) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> x;
  for (int i = 0; i < n; ++i) x.push_back(Vec3(gauss(random), gauss(random), gauss(random)).normalized());
  return x;
}

/// Median distance of neighbours in n points of the unit sphere.
double even_spacing(int n) { return 1.95 * std::sqrt(pi / n); }
double random_spacing(int n) { return 2 * std::sqrt(std::numbers::ln2 / n); }

using Mask = std::function<bool(const Vec3&)>;

Mask cap(const Vec3& axis, double angle) {
  return [=](const Vec3& x) { return x.dot(axis) > std::cos(angle); };
}

ClosedHoles holes(const Sphere& sphere, std::vector<Vec3> samples, double spacing, const Mask& removed) {
  std::erase_if(samples, removed);
  const std::vector<double> support = SampleDistance(samples).distances(sphere.V);
  return find_closed_holes(sphere.V, sphere.faces, support, kSupportRadius * spacing);
}

TEST(ClosedHoles, AHoleHasTheSizeOfWhatWasCutOut) {
  const Sphere sphere;
  constexpr int n = 20000;
  for (const bool even : {true, false}) {
    for (const double angle : {.25, .4, .8, 2.}) {
      const double spacing = even ? even_spacing(n) : random_spacing(n);
      const ClosedHoles found =
          holes(sphere, even ? even_samples(n) : random_samples(n), spacing, cap(Vec3::UnitX(), angle));
      ASSERT_EQ(found.holes.size(), 1u) << angle;
      const ClosedHole& hole = found.holes[0];
      EXPECT_NEAR(hole.rim_length, 2 * pi * std::sin(angle), .05 * 2 * pi * std::sin(angle)) << angle;
      EXPECT_NEAR(hole.area, 2 * pi * (1 - std::cos(angle)), .08 * 2 * pi * (1 - std::cos(angle))) << angle;
      EXPECT_NEAR(hole.area_fraction, hole.area / (4 * pi), 1e-2 * hole.area_fraction);
      EXPECT_NEAR(hole.deepest, 2 * std::sin(angle / 2), spacing + .02) << angle;
      EXPECT_NEAR(hole.deepest_over_spacing, hole.deepest / spacing, 1e-9);
      EXPECT_EQ(hole.n_rims, 1u);
      EXPECT_NEAR(hole.rim_diameter, 2 * std::sin(angle), .08) << angle;
      EXPECT_GT(hole.centre.normalized().x(), .999);
      EXPECT_NEAR(hole.centre.norm(), (1 + std::cos(angle)) / 2, .02) << angle;
    }
  }
}

TEST(ClosedHoles, FacesOfAHoleAreThoseInside) {
  const Sphere sphere;
  constexpr double angle = .5;
  const ClosedHoles found = holes(sphere, even_samples(20000), even_spacing(20000), cap(Vec3::UnitZ(), angle));
  ASSERT_EQ(found.of_face.size(), sphere.faces.size());
  double area = 0;
  for (std::size_t f = 0; f < sphere.faces.size(); ++f) {
    const auto& [a, b, c] = sphere.faces[f];
    const double at = std::acos((sphere.V[a] + sphere.V[b] + sphere.V[c]).normalized().z());
    EXPECT_EQ(found.of_face[f], at < angle - .03 ? 0 : at > angle + .03 ? -1 : found.of_face[f]) << at;
    if (found.of_face[f] == 0) area += (sphere.V[b] - sphere.V[a]).cross(sphere.V[c] - sphere.V[a]).norm() / 2;
  }
  EXPECT_NEAR(area, found.holes[0].area, .02 * area) << "what is exported has the area of the certificate";
}

TEST(ClosedHoles, TwoAreSortedByAreaWhateverTheOrderOfTheFaces) {
  Sphere sphere;
  const Mask both = [](const Vec3& x) { return cap(Vec3::UnitX(), .25)(x) || cap(-Vec3::UnitY(), .4)(x); };
  const ClosedHoles found = holes(sphere, even_samples(20000), even_spacing(20000), both);
  ASSERT_EQ(found.holes.size(), 2u);
  EXPECT_LT(found.holes[0].centre.y(), -.9);
  EXPECT_GT(found.holes[1].centre.x(), .9);
  std::shuffle(sphere.faces.begin(), sphere.faces.end(), std::mt19937_64(1));
  const ClosedHoles shuffled = holes(sphere, even_samples(20000), even_spacing(20000), both);
  ASSERT_EQ(shuffled.holes.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(shuffled.holes[k].area, found.holes[k].area, 1e-12);
    EXPECT_NEAR(shuffled.holes[k].rim_length, found.holes[k].rim_length, 1e-12);
    EXPECT_EQ(shuffled.holes[k].rim_diameter, found.holes[k].rim_diameter);
  }
}

TEST(ClosedHoles, ABeltHasTwoRims) {
  const Sphere sphere;
  const ClosedHoles found =
      holes(sphere, even_samples(20000), even_spacing(20000), [](const Vec3& x) { return std::abs(x.z()) < .3; });
  ASSERT_EQ(found.holes.size(), 1u);
  const ClosedHole& belt = found.holes[0];
  EXPECT_EQ(belt.n_rims, 2u);
  EXPECT_NEAR(belt.rim_length, 4 * pi * std::sqrt(1 - .09), .03 * belt.rim_length);
  EXPECT_NEAR(belt.area, 4 * pi * .3, .05 * belt.area);
  EXPECT_NEAR(belt.rim_diameter, 2, .02);
  EXPECT_LT(belt.centre.norm(), .02);
}

TEST(ClosedHoles, GapsOfRandomSamplesAreNone) {
  const Sphere sphere;
  for (const int n : {1000, 20000, 200000}) {
    const std::vector<double> support = SampleDistance(random_samples(n)).distances(sphere.V);
    const double radius = kSupportRadius * random_spacing(n);
    if (n < 200000) {
      EXPECT_GT(*std::max_element(support.begin(), support.end()), radius) << "there are gaps";
    }
    const ClosedHoles found = find_closed_holes(sphere.V, sphere.faces, support, radius);
    EXPECT_TRUE(found.holes.empty()) << n;
    EXPECT_EQ(std::count(found.of_face.begin(), found.of_face.end(), -1), static_cast<long>(sphere.faces.size()));
  }
}

TEST(ClosedHoles, AHoleIsTwelveSpacingsWideAtLeast) {
  const Sphere sphere;
  const double spacing = even_spacing(5000);
  EXPECT_TRUE(holes(sphere, even_samples(5000), spacing, cap(Vec3::UnitX(), 4.5 * spacing)).holes.empty());
  EXPECT_EQ(holes(sphere, even_samples(5000), spacing, cap(Vec3::UnitX(), 7.5 * spacing)).holes.size(), 1u);
}

TEST(ClosedHoles, APieceWithoutSamplesHasNoRim) {
  Sphere sphere;
  const std::size_t n = sphere.V.size();
  for (std::size_t v = 0; v < n; ++v) sphere.V.push_back(sphere.V[v] + Vec3(5, 0, 0));
  const std::vector<Triangle> first = sphere.faces;
  for (const auto& [a, b, c] : first) {
    const int k = static_cast<int>(n);
    sphere.faces.push_back({a + k, b + k, c + k});
  }
  const ClosedHoles found = holes(sphere, even_samples(5000), even_spacing(5000), [](const Vec3&) { return false; });
  ASSERT_EQ(found.holes.size(), 1u);
  EXPECT_EQ(found.holes[0].n_rims, 0u);
  EXPECT_EQ(found.holes[0].rim_length, 0);
  EXPECT_EQ(found.holes[0].rim_diameter, 0);
  EXPECT_NEAR(found.holes[0].area_fraction, .5, 1e-9);
  EXPECT_NEAR(found.holes[0].centre.x(), 5, 1e-6);
}

TEST(ClosedHoles, WithoutARadiusThereAreNone) {
  const Sphere sphere;
  const std::vector<double> far(sphere.V.size(), 1.);
  EXPECT_TRUE(find_closed_holes(sphere.V, sphere.faces, far, 0).holes.empty());
  EXPECT_EQ(find_closed_holes(sphere.V, sphere.faces, far, .1).holes.size(), 1u);
  const std::vector<double> wall(sphere.V.size(), -1.);
  EXPECT_TRUE(find_closed_holes(sphere.V, sphere.faces, wall, .1).holes.empty());
}

TEST(SupportReport, ListsTheLargestAndCountsAll) {
  const Sphere sphere;
  const std::vector<Vec3> centres = even_samples(128);
  const SampleDistance to_centres(centres);
  std::vector<Vec3> samples = even_samples(400000);
  const std::vector<double> distance = to_centres.distances(samples);
  std::size_t n = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (distance[i] > .1) samples[n++] = samples[i];
  }
  samples.resize(n);
  Domain domain;
  domain.shift = Vec3(10, 0, 0);
  domain.cloud_spacing = even_spacing(400000);
  domain.cloud.points = samples;
  const SupportReport report = support_report(domain, sphere.V, sphere.faces);
  EXPECT_DOUBLE_EQ(report.radius, kSupportRadius * domain.cloud_spacing);
  EXPECT_EQ(report.n_closed_holes, 128u);
  ASSERT_EQ(report.closed_holes.size(), kListedHoles);
  EXPECT_NEAR(report.unsupported_area_fraction, 128 * std::pow((.1 - report.radius) / 2, 2), .05);
  for (std::size_t k = 0; k < kListedHoles; ++k) {
    EXPECT_LT(to_centres.distances({report.closed_holes[k].centre - domain.shift})[0], .02);
    EXPECT_TRUE(k == 0 || report.closed_holes[k].area <= report.closed_holes[k - 1].area);
  }
}

}  // namespace
}  // namespace umtet
