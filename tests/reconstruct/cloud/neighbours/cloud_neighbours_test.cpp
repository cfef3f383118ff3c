#include "reconstruct/cloud/neighbours/cloud_neighbours.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>

namespace umtet {
namespace {

constexpr double kPi = std::numbers::pi;

/// Near-lattice samples of the unit sphere: the golden spiral.
std::vector<Vec3> spiral_sphere(int n) {
  std::vector<Vec3> points;
  const double golden_angle = kPi * (3 - std::sqrt(5.0));
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(i * golden_angle), r * std::sin(i * golden_angle), z);
  }
  return points;
}

/// White-noise samples of the unit sphere with height z = quantile(u), u uniform in (0, 1).
template <class Quantile>
std::vector<Vec3> random_sphere(int n, Quantile quantile) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double z = quantile(uniform(generator)), r = std::sqrt(1 - z * z), angle = 2 * kPi * uniform(generator);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

std::vector<Vec3> uniform_random_sphere(int n) {
  return random_sphere(n, [](double u) { return 2 * u - 1; });
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(NeighbourDistances, AgreeWithAllPairs) {
  const std::vector<Vec3> points = uniform_random_sphere(400);
  const int k = 5;
  const NeighbourDistances near = neighbour_distances(points, k);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<double> d2;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) d2.push_back((points[j] - points[i]).squaredNorm());
    std::sort(d2.begin(), d2.end());
    EXPECT_NEAR(near.nearest[i], std::sqrt(d2[0]), 1e-15);  // same subtraction, another order of the three squares
    EXPECT_NEAR(near.mean_square[i], std::accumulate(d2.begin(), d2.begin() + k, 0.0) / k, 1e-15);
    EXPECT_EQ(near.multiplicity[i], 1);
  }
}

TEST(NeighbourDistances, DoNotDependOnTheNumberOfThreads) {
  const std::vector<Vec3> points = uniform_random_sphere(20000);
  const NeighbourDistances many = neighbour_distances(points, 8);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const NeighbourDistances one = neighbour_distances(points, 8);
  EXPECT_EQ(many.nearest, one.nearest);
  EXPECT_EQ(many.mean_square, one.mean_square);
}

TEST(NeighbourDistances, OfNeighboursThatAreKnownAreTheSameBits) {
  std::vector<Vec3> points = uniform_random_sphere(3000);
  const NeighbourDistances searched = neighbour_distances(points, kAreaNeighbours);
  // A power of two, and few enough bits left of it: the differences stay what they are.
  for (Vec3& x : points) x = (x + Vec3::Constant(16)) - Vec3::Constant(16);
  const NeighbourDistances rounded = neighbour_distances(points, kAreaNeighbours);
  for (Vec3& x : points) x += Vec3::Constant(16);
  const NeighbourDistances known = neighbour_distances(points, Neighbourhoods(points, kAreaNeighbours));
  EXPECT_NE(searched.mean_square, rounded.mean_square);
  EXPECT_EQ(known.k, rounded.k);
  EXPECT_EQ(known.nearest, rounded.nearest);
  EXPECT_EQ(known.mean_square, rounded.mean_square);
  EXPECT_EQ(known.multiplicity, rounded.multiplicity);
}

TEST(NeighbourDistances, RefuseWhatHasNoSpacing) {
  EXPECT_THROW(neighbour_distances({}, 1), std::invalid_argument);
  EXPECT_THROW(neighbour_distances(std::vector<Vec3>(20, Vec3::Ones()), 1), std::invalid_argument);
  EXPECT_THROW(neighbour_distances(spiral_sphere(20), 0), std::invalid_argument);
  std::vector<Vec3> points = spiral_sphere(20);
  points[7].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(neighbour_distances(points, 1), std::invalid_argument);
}

TEST(NeighbourDistances, UseAllPlacesWhereThereAreFewerThanAsked) {
  const NeighbourDistances near = neighbour_distances({{0, 0, 0}, {3, 0, 0}, {0, 4, 0}}, 8);
  EXPECT_EQ(near.k, 2);
  EXPECT_DOUBLE_EQ(near.mean_square[0], (9.0 + 16.0) / 2);
}

TEST(MedianSpacing, IsThatOfASquareLatticeWhateverIsDoubled) {
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) points.emplace_back(0.25 * i, 0.25 * j, 0);
  EXPECT_EQ(median_spacing(points), 0.25);
  const std::vector<Vec3> once = points;
  points.insert(points.end(), once.begin(), once.end());
  EXPECT_EQ(median_spacing(points), 0.25);
}

// By its law (see the header) the sum is 0.929 of the area for white noise; the spiral is a lattice, 1.031 here.
TEST(SampleAreas, SumToTheAreaOfAUniformlySampledSphere) {
  EXPECT_NEAR(sum(sample_areas(spiral_sphere(5000))), 4 * kPi, 0.09 * 4 * kPi);
  EXPECT_NEAR(sum(sample_areas(uniform_random_sphere(5000))), 4 * kPi, 0.09 * 4 * kPi);
}

TEST(SampleAreas, ScaleWithTheSquareOfTheUnit) {
  std::vector<Vec3> points = uniform_random_sphere(500);
  const std::vector<double> areas = sample_areas(points);
  for (Vec3& x : points) x *= 1024;  // a power of two: exact
  const std::vector<double> scaled = sample_areas(points);
  for (std::size_t i = 0; i < areas.size(); ++i) EXPECT_EQ(scaled[i], 1024 * 1024 * areas[i]);
}

// Points per area proportional to exp(2 z): e^4 : 1 from pole to pole. Zone by zone (equal height = equal area) the
// a_i have to add up to the zone's area. White noise of 20000: the sparsest zone has about 240 points, so its own
// count fluctuates by 6 % and 20 % is 3 sigma.
TEST(SampleAreas, AreLocallyRightOnACloudOfVaryingDensity) {
  const double e4 = std::exp(4.0);
  const std::vector<Vec3> points = random_sphere(20000, [e4](double u) { return std::log(1 + u * (e4 - 1)) / 2 - 1; });
  const std::vector<double> areas = sample_areas(points);
  std::vector<double> zone(8, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i)
    zone[std::min(7, static_cast<int>(4 * (points[i].z() + 1)))] += areas[i];
  for (const double area : zone) EXPECT_NEAR(area, 4 * kPi / 8, 0.2 * 4 * kPi / 8);
}

TEST(SampleAreas, AreSharedByDuplicates) {
  std::vector<Vec3> points = uniform_random_sphere(1000);
  const std::vector<double> single = sample_areas(points);
  for (int i = 0; i < 30; ++i) points.push_back(points[17]);  // more copies than neighbours looked at
  const std::vector<double> areas = sample_areas(points);
  EXPECT_NEAR(sum(areas), sum(single), 1e-12 * sum(single));
  EXPECT_EQ(areas[17], single[17] / 31);
  for (const double a : areas) EXPECT_GT(a, 0);
}

TEST(FarOriginShift, IsZeroForOrdinaryClouds) {
  OrientedPointCloud cloud{spiral_sphere(50), {}};
  EXPECT_EQ(far_origin_shift(cloud), Vec3::Zero());
  for (Vec3& x : cloud.points) x.x() += 100;
  EXPECT_EQ(far_origin_shift(cloud), Vec3::Zero());
  EXPECT_EQ(far_origin_shift({}), Vec3::Zero());
}

TEST(FarOriginShift, IsExactlyUndone) {
  // UTM-like: metres east, north, height of a body of 2 m; height stays where it is, near 0.
  OrientedPointCloud cloud{uniform_random_sphere(2000), {}};
  for (Vec3& x : cloud.points) x += Vec3(431072.37, -5411830.9, 0.4);
  const Vec3 shift = far_origin_shift(cloud);
  EXPECT_NEAR(shift.x(), 431072.37, 2);
  EXPECT_NEAR(shift.y(), -5411830.9, 2);
  EXPECT_EQ(shift.z(), 0);
  for (const Vec3& x : cloud.points) {
    const Vec3 y = x - shift;
    EXPECT_LE(y.norm(), 4);
    EXPECT_EQ(y + shift, x);
    for (int a = 0; a < 3; ++a)  // no rounding in the subtraction itself: the long double one gives the same
      EXPECT_EQ(static_cast<long double>(y[a]), static_cast<long double>(x[a]) - static_cast<long double>(shift[a]));
  }
}

}  // namespace
}  // namespace umtet
