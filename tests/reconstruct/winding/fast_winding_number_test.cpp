#include "reconstruct/winding/fast_winding_number.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "tests/support/clouds.h"
#include "tests/support/sampled_domains.h"

namespace umtet {
namespace {

std::vector<Vec3> places_around(const OrientedPointCloud& cloud, int n) {
  std::mt19937_64 random(7);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.points) box.extend(x);
  std::uniform_real_distribution<double> unit(-0.25, 1.25);
  std::vector<Vec3> places;
  for (int i = 0; i < n; ++i) {
    const Vec3 t(unit(random), unit(random), unit(random));
    places.push_back(box.min() + t.cwiseProduct(box.sizes()));
  }
  return places;
}

FastWindingNumber of(const OrientedPointCloud& cloud, double beta = 2, double softening = 1) {
  return {cloud.points, cloud.normals, sample_areas(cloud.points), {.beta = beta, .softening = softening}};
}

constexpr double kDirect = std::numeric_limits<double>::infinity();

TEST(FastWindingNumber, IsTheSumOverAllSamples) {
  for (const testing::AnalyticDomain& domain : testing::domains()) {
    const OrientedPointCloud cloud = test::sampled(domain, 8000);
    const FastWindingNumber fast = of(cloud), direct = of(cloud, kDirect);
    double most = 0, sum = 0;
    const std::vector<Vec3> places = places_around(cloud, 1000);
    for (const Vec3& x : places) {
      const double error = std::abs(fast(x) - direct(x));
      most = std::max(most, error);
      sum += error;
    }
    EXPECT_LT(most, 3e-2) << domain.name;
    EXPECT_LT(sum / static_cast<double>(places.size()), 4e-3) << domain.name;
  }
}

TEST(FastWindingNumber, ErrorFallsWithBeta) {
  const OrientedPointCloud cloud = test::torus_cloud(8000);
  const FastWindingNumber two = of(cloud, 2), four = of(cloud, 4), direct = of(cloud, kDirect);
  double error_two = 0, error_four = 0;
  for (const Vec3& x : places_around(cloud, 1000)) {
    error_two += std::abs(two(x) - direct(x));
    error_four += std::abs(four(x) - direct(x));
  }
  EXPECT_LT(error_four, error_two / 4);
}

TEST(FastWindingNumber, TellsInsideFromOutside) {
  const OrientedPointCloud cloud = test::torus_cloud(8000);
  const FastWindingNumber w = of(cloud);
  for (const Vec3& x : places_around(cloud, 1000)) {
    const double distance = test::torus_distance(x);
    if (std::abs(distance) < 0.05) continue;
    EXPECT_NEAR(w(x), distance < 0 ? 1 : 0, 0.25) << x.transpose();
  }
}

TEST(FastWindingNumber, IsAboutAHalfAtSamplesAndFallsOutward) {
  const OrientedPointCloud cloud = test::torus_cloud(8000);
  std::vector<Vec3> gradients;
  const std::vector<double> w = of(cloud, 2, 3).evaluate(cloud.points, &gradients);
  for (std::size_t i = 0; i < w.size(); ++i) {
    EXPECT_NEAR(w[i], 0.5, 0.25);
    EXPECT_LT(gradients[i].normalized().dot(cloud.normals[i]), -0.7);
  }
}

TEST(FastWindingNumber, GradientIsThatOfTheSum) {
  const OrientedPointCloud cloud = test::torus_cloud(500);
  for (const double softening : {0., 1., 4.}) {
    const FastWindingNumber w = of(cloud, 3, softening);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const Vec3& x : {Vec3(1, 0, 0.05), Vec3(0.1, 0.2, 0.3), Vec3(3, 1, 2), Vec3(1, 0.97, 0.03)}) {
      Vec3 gradient;
      w.evaluate(x, &gradient);
      constexpr double kStep = 1e-6;
      for (int a = 0; a < 3; ++a) {
        const Vec3 step = kStep * Vec3::Unit(a);
        EXPECT_NEAR(gradient[a], (w(x + step) - w(x - step)) / (2 * kStep), 1e-5 * (1 + gradient.norm()));
      }
    }
  }
}

TEST(FastWindingNumber, ChangesNeitherWithUnitNorWithPlace) {
  const OrientedPointCloud cloud = test::torus_cloud(2000);
  OrientedPointCloud moved = cloud;
  for (Vec3& x : moved.points) x = 1000 * x + Vec3(1e4, -1e4, 1e4);
  const FastWindingNumber w = of(cloud), w_moved = of(moved);
  for (const Vec3& x : places_around(cloud, 100)) EXPECT_NEAR(w(x), w_moved(1000 * x + Vec3(1e4, -1e4, 1e4)), 1e-9);
}

TEST(FastWindingNumber, OtherNormalsAreThoseOfANewOne) {
  const OrientedPointCloud cloud = test::torus_cloud(2000);
  OrientedPointCloud turned = cloud;
  for (Vec3& n : turned.normals) n = -n;
  FastWindingNumber w = of(cloud);
  w.set_normals(turned.normals);
  const FastWindingNumber anew = of(turned);
  for (const Vec3& x : places_around(cloud, 100)) EXPECT_EQ(w(x), anew(x));
}

TEST(FastWindingNumber, HasTheSameBitsForAnyNumberOfThreads) {
  const OrientedPointCloud cloud = test::torus_cloud(5000);
  const std::vector<Vec3> places = places_around(cloud, 1000);
  const auto values = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return of(cloud).evaluate(places);
  };
  EXPECT_EQ(values(1), values(4));
}

TEST(FastWindingNumber, SamplesAtOnePlaceAndASingleOneAreNoTrouble) {
  const std::vector<Vec3> same(100, Vec3(1, 2, 3)), up(100, Vec3(0, 0, 1));
  const FastWindingNumber w(same, up, std::vector<double>(100, 0.01));
  EXPECT_NEAR(w(Vec3(1, 2, 1)), 1 / (16 * std::numbers::pi), 1e-12);  // one square unit, seen from two
  EXPECT_EQ(w(Vec3(1, 2, 3)), 0);
  const FastWindingNumber bare({Vec3::Zero()}, {Vec3::UnitX()}, {1}, {.beta = 2, .softening = 0});
  EXPECT_EQ(bare(Vec3::Zero()), 0);
}

TEST(FastWindingNumber, RefusesWhatIsNoCloud) {
  const std::vector<Vec3> one = {Vec3::Zero()};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(FastWindingNumber({}, {}, {}), std::invalid_argument);
  EXPECT_THROW(FastWindingNumber(one, {}, {1}), std::invalid_argument);
  EXPECT_THROW(FastWindingNumber(one, one, {}), std::invalid_argument);
  EXPECT_THROW(FastWindingNumber(one, one, {-1}), std::invalid_argument);
  EXPECT_THROW(FastWindingNumber({Vec3(nan, 0, 0)}, one, {1}), std::invalid_argument);
  EXPECT_THROW(FastWindingNumber(one, {Vec3(nan, 0, 0)}, {1}), std::invalid_argument);
  EXPECT_EQ(problems(WindingNumberParams{.beta = 1, .softening = -1}).size(), 2U);
}

}  // namespace
}  // namespace umtet
