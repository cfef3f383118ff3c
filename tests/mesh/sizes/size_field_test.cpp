// Size fields against the formula, evaluated source by source.

#include "mesh/sizes/size_field.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace umtet;

namespace {

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const double x = u(random), y = u(random);
  return {x, y, u(random)};
}

/// Sources of sizes that differ by hundreds, many of them in clusters.
std::vector<SizeSource> some_sources(std::size_t n, bool with_radius) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<SizeSource> all;
  Vec3 cluster = in_cube(random);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 100 == 0) cluster = in_cube(random);
    const Vec3 x = i % 3 == 0 ? in_cube(random) : Vec3(cluster + .02 * in_cube(random));
    const double h = std::pow(10, -3 + 2.5 * u(random));
    all.push_back({x, h, with_radius ? 2 * h * u(random) : 0});
  }
  return all;
}

double by_formula(const std::vector<SizeSource>& sources, const SizeFieldParams& p, const Vec3& x) {
  double least = p.h_max;
  for (const SizeSource& s : sources) {
    least = std::min(least, std::max(s.h, p.h_min) + p.grade * std::max(0., (s.x - x).norm() - s.radius));
  }
  return least;
}

/// Of all points of a cube the one that is nearest to s.
Vec3 nearest_in(const Vec3& centre, double half_width, const Vec3& s) {
  const Vec3 half = Vec3::Constant(half_width);
  return s.cwiseMax(centre - half).cwiseMin(centre + half);
}

class SizeFieldOf : public testing::TestWithParam<bool> {};

}  // namespace

TEST_P(SizeFieldOf, SourcesIsTheLeastOfTheirCones) {
  const std::vector<SizeSource> sources = some_sources(20000, GetParam());
  const SizeFieldParams params{.grade = .3, .h_min = .002, .h_max = .4};
  const SizeField field(sources, params);
  EXPECT_LT(field.sources().size(), sources.size());
  std::mt19937_64 random(8);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = i % 2 ? Vec3(1.2 * in_cube(random)) : Vec3(sources[7 * i].x + .01 * in_cube(random));
    const double exact = by_formula(sources, params, x);
    EXPECT_GE(field.at(x), exact * .95);
    EXPECT_LE(field.at(x), exact * 1.05);
  }
}

TEST_P(SizeFieldOf, SourcesKnowsTheLeastInACube) {
  const SizeFieldParams params{.grade = .3, .h_min = .002, .h_max = .4};
  const SizeField field(some_sources(20000, GetParam()), params);
  std::mt19937_64 random(10);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 centre = in_cube(random);
    const double half_width = .5 * std::pow(.5, i % 8);
    double exact = params.h_max;
    for (const SizeSource& s : field.sources()) {
      exact = std::min(exact, by_formula({s}, params, nearest_in(centre, half_width, s.x)));
    }
    EXPECT_LE(field.least_in(centre, half_width), exact * (1 + 1e-12));
    EXPECT_GE(field.least_in(centre, half_width), exact * .95);
  }
}

INSTANTIATE_TEST_SUITE_P(, SizeFieldOf, testing::Bool());

TEST(SizeField, OfNothingIsTheGreatestSize) {
  const SizeField field({}, {.h_min = .1, .h_max = 2});
  EXPECT_EQ(field.at({1, 2, 3}), 2);
  EXPECT_EQ(field.least_in({1, 2, 3}, 4), 2);
}

TEST(SizeField, KeepsASourceOfEachSizeAndNoneTwice) {
  const std::vector<SizeSource> twice(1000, {{0, 0, 0}, .1});
  EXPECT_EQ(SizeField(twice, {.h_min = .01, .h_max = 1}).sources().size(), 1);
}

TEST(SizeField, OfASurfaceGrowsAwayFromIt) {
  std::vector<SizeSource> sphere;
  for (int i = 0; i < 40000; ++i) {
    const double z = (i + .5) / 20000 - 1, a = i * 2.39996;
    sphere.push_back({{std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z}, .05, .05});
  }
  const SizeField field(sphere, {.grade = .3, .h_min = .01, .h_max = 1});
  for (const double r : {0., .3, .6, .9, 1., 1.2, 2.}) {
    const double exact = .05 + .3 * std::max(0., std::abs(r - 1) - .05);
    EXPECT_NEAR(field.at({0, 0, r}), exact, .05 * exact) << r;
  }
}

TEST(SizeField, OfAFunctionThatIsFlatEnoughIsThatFunction) {
  const auto f = [](const Vec3& x) { return .05 + .2 * std::abs(x.x()); };
  const SizeField field({}, {.grade = .3, .h_min = .01, .h_max = 1},
                        SizeFunction{f, Box(Vec3::Constant(-1), Vec3::Constant(1))});
  EXPECT_TRUE(field.sources().empty());
  std::mt19937_64 random(11);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = in_cube(random);
    EXPECT_EQ(field.at(x), f(x));
    EXPECT_LE(field.least_in(x, .1), f(x));
  }
}

TEST(SizeField, OfAFunctionThatIsSteepRisesFromItsLowerEnds) {
  // A ball of .02 in .5: h may grow by .3 from its surface on.
  const auto f = [](const Vec3& x) { return x.norm() < .3 ? .02 : .5; };
  const SizeField field({}, {.grade = .3, .h_min = .001, .h_max = 1},
                        SizeFunction{f, Box(Vec3::Constant(-1), Vec3::Constant(1))});
  std::mt19937_64 random(12);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = in_cube(random);
    const double exact = std::min(.5, .02 + .3 * std::max(0., x.norm() - .3));
    EXPECT_LE(field.at(x), 1.05 * exact + .3 * .02);
    EXPECT_GE(field.at(x), .95 * exact);
  }
}

TEST(SizeField, OfACuspRisesFromItsTip) {
  // Four times as steep as grade allows: only the tip matters, which no sample of the coarse cubes meets.
  const Vec3 tip(.1234, .0567, -.0891);
  const auto f = [&](const Vec3& x) { return .004 + 1.2 * (x - tip).norm(); };
  const SizeField field({}, {.grade = .3, .h_min = .001, .h_max = 1},
                        SizeFunction{f, Box(Vec3::Constant(-1), Vec3::Constant(1))});
  std::mt19937_64 random(13);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = in_cube(random);
    EXPECT_NEAR(field.at(x), .004 + .3 * (x - tip).norm(), .06 * field.at(x));
  }
}

TEST(SizeField, OfAFunctionWithoutAValueIsTheGreatestSizeThere) {
  const auto f = [](const Vec3& x) { return std::sqrt(x.x()); };
  const SizeField field({}, {.grade = 100, .h_min = .01, .h_max = .7},
                        SizeFunction{f, Box(Vec3::Constant(-1), Vec3::Constant(1))});
  EXPECT_EQ(field.at({-.9, 0, 0}), .7);
  EXPECT_NEAR(field.at({.25, 0, 0}), .5, 1e-12);
}

TEST(SizeField, RefinedIsTheSameWhereTheNewSourcesAskForMore) {
  std::vector<SizeSource> sources;
  for (int i = 0; i < 200; ++i) sources.push_back({Vec3(std::cos(i), std::sin(i), .01 * i), .1, .05});
  const SizeField field(sources, {.grade = .3, .h_min = .05, .h_max = 1});
  const Vec3 spot(1, 0, 0);
  const SizeField finer = field.refined({{spot, .02, .1}});
  EXPECT_EQ(finer.at(spot), .02);
  EXPECT_EQ(finer.least_in(spot, .05), .02);
  const SizeField finest = finer.refined({{-spot, .03, .1}});
  EXPECT_EQ(finest.at(spot), .02);
  EXPECT_EQ(finest.at(-spot), .03);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x(2 * std::sin(7. * i), 2 * std::sin(11. * i), 2 * std::sin(13. * i));
    const double of_spot = .02 + .3 * std::max(0., (x - spot).norm() - .1);
    if (of_spot > 1.06 * field.at(x)) {
      EXPECT_EQ(finer.at(x), field.at(x));
    } else {
      EXPECT_LE(finer.at(x), (1 + 1e-12) * std::min(field.at(x), of_spot));
    }
  }
  EXPECT_THROW(field.refined({{spot, -1, 0}}), std::invalid_argument);
}

TEST(SizeField, IsTheSameForEveryNumberOfThreads) {
  const auto f = [](const Vec3& x) { return x.norm() < .3 ? .02 : .5; };
  const auto make = [&](std::size_t n_threads) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n_threads);
    return SizeField(some_sources(50000, true), {.grade = .3, .h_min = .002, .h_max = .4},
                     SizeFunction{f, Box(Vec3::Constant(-1), Vec3::Constant(1))});
  };
  const SizeField one = make(1), four = make(4);
  ASSERT_EQ(one.sources().size(), four.sources().size());
  for (std::size_t i = 0; i < one.sources().size(); ++i) {
    EXPECT_EQ(one.sources()[i].x, four.sources()[i].x);
    EXPECT_EQ(one.sources()[i].h, four.sources()[i].h);
    EXPECT_EQ(one.sources()[i].radius, four.sources()[i].radius);
  }
}

TEST(SizeField, ListsEveryFault) {
  try {
    SizeField({{{0, 0, 0}, -1}}, {.grade = 0, .h_min = 0, .h_max = -1});
    FAIL();
  } catch (const std::invalid_argument& e) {
    const std::string what = e.what();
    for (const char* word : {"grade", "h_min", "h_max", "source 0"}) EXPECT_NE(what.find(word), what.npos) << what;
  }
}
