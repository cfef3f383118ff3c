#include "reconstruct/cloud/transfer/field_transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "reconstruct/cloud/cleaning/cleaning.h"
#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/morton_order.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {

double height(const Vec3& x) { return 20 + 3 * x.x() - 2 * x.y(); }
Colour shade(const Vec3& x) { return {static_cast<std::uint8_t>(x.x() < 0 ? 10 : 200), 50, 255}; }

void add_fields(OrientedPointCloud& cloud) {
  cloud.fields = {{"height", {}}, {"constant", std::vector<double>(cloud.points.size(), 7.25)}};
  for (const Vec3& x : cloud.points) {
    cloud.fields[0].values.push_back(height(x));
    cloud.colours.push_back(shade(x));
  }
}

OrientedPointCloud torus(int n) {
  OrientedPointCloud cloud = test::torus_cloud(n);
  add_fields(cloud);
  return cloud;
}

TEST(FieldsAt, AreWithinTheSpacingTimesTheGradient) {
  const OrientedPointCloud asked = test::torus_cloud(3000, 2);
  double before = 0;
  for (const int n : {4000, 16000}) {
    const OrientedPointCloud cloud = torus(n);
    const SurfaceFields found = fields_at(cloud, asked.points, asked.normals, 1);
    const double spacing = std::sqrt(4 * M_PI * M_PI * test::kTorusR * test::kTorusr / n);
    double sum2 = 0;
    for (std::size_t i = 0; i < asked.points.size(); ++i) {
      const double error = found.fields[0].values[i] - height(asked.points[i]);
      // Of samples at random thirteen lie within three spacings.
      EXPECT_LT(std::abs(error), 3 * spacing * std::sqrt(13));
      sum2 += error * error;
      EXPECT_NEAR(found.fields[1].values[i], 7.25, 1e-14);
      EXPECT_NEAR(found.colours[i].z(), 1, 1e-15);
    }
    const double rms = std::sqrt(sum2 / 3000);
    if (before > 0) {
      EXPECT_LT(rms, .6 * before);
    }
    before = rms;
  }
}

TEST(FieldsAt, TheOtherSideOfAThinSheetIsNotMixedIn) {
  OrientedPointCloud cloud = test::plane_cloud(20, Vec3::UnitZ());
  const OrientedPointCloud top = cloud;
  SampleField t{"t", std::vector<double>(cloud.points.size(), 20)};
  // The lower side has sixteen times as many samples: a hundred are nearer than the thirteenth of the upper one.
  for (const Vec3& x : test::plane_cloud(80, Vec3::UnitZ()).points) {
    cloud.points.push_back(x - 1e-3 * Vec3::UnitZ());
    cloud.normals.push_back(-Vec3::UnitZ());
    t.values.push_back(80);
  }
  cloud.fields = {t};
  const auto expect = [&](const Vec3& normal, double least, double most) {
    const SurfaceFields found = fields_at(cloud, top.points, std::vector<Vec3>(top.points.size(), normal), 1);
    for (const double v : found.fields[0].values) {
      EXPECT_GE(v, least);
      EXPECT_LE(v, most);
    }
  };
  expect(Vec3::UnitZ(), 20 - 1e-12, 20 + 1e-12);
  expect(-Vec3::UnitZ(), 80 - 1e-12, 80 + 1e-12);
  expect(Vec3::Zero(), 20.1, 79.9);  // no side
}

TEST(FieldsAt, WhatIsFarFromSamplesOrNotMeasuredHasNoValue) {
  OrientedPointCloud cloud = test::plane_cloud(20, Vec3::UnitZ());
  add_fields(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.points[i].x() < 0) cloud.fields[1].values[i] = i % 2 == 0 ? NAN : INFINITY;
  }
  const std::vector<Vec3> places = {{0, 0, 0}, {.49 + .15, 0, 0}, {.45 + .05, 0, 0}, {-.3, 0, 0}, {.3, 0, 0}};
  const SurfaceFields found = fields_at(cloud, places, std::vector<Vec3>(5, Vec3::UnitZ()), .15);
  const std::vector<double>&h = found.fields[0].values, &c = found.fields[1].values;
  EXPECT_TRUE(std::isnan(h[1]) && std::isnan(c[1]) && found.colours[1].array().isNaN().all());
  EXPECT_FALSE(std::isnan(h[2]));
  EXPECT_FALSE(std::isnan(h[3]));
  EXPECT_TRUE(std::isnan(c[3])) << "no sample that is near was measured";
  EXPECT_NEAR(c[4], 7.25, 1e-14);
  EXPECT_NEAR(c[0], 7.25, 1e-14) << "those that were measured count";
  // All that look to the other side say nothing.
  EXPECT_TRUE(std::isnan(fields_at(cloud, {places[4]}, {-Vec3::UnitZ()}, .15).fields[0].values[0]));
}

TEST(FieldsAt, AreContinuous) {
  const OrientedPointCloud cloud = torus(2000);
  std::vector<Vec3> places, normals;
  for (int k = 0; k < 20000; ++k) {
    const double a = 1e-4 * k;
    places.emplace_back((test::kTorusR + test::kTorusr) * Vec3(std::cos(a), std::sin(a), 0));
    normals.emplace_back(std::cos(a), std::sin(a), 0);
  }
  const std::vector<double> f = fields_at(cloud, places, normals, .3).fields[0].values;
  for (std::size_t k = 1; k < f.size(); ++k) EXPECT_LT(std::abs(f[k] - f[k - 1]), 1e-2);
}

TEST(FieldsAt, CloudsWithoutNormalsOrValuesAreRefused) {
  OrientedPointCloud cloud = torus(100);
  EXPECT_THROW(fields_at(cloud, cloud.points, {}, 1), std::invalid_argument);
  EXPECT_THROW(fields_at(cloud, {}, {}, 0), std::invalid_argument);
  cloud.fields[1].values.pop_back();
  EXPECT_THROW(fields_at(cloud, {}, {}, 1), std::invalid_argument);
}

void expect_own_fields(const OrientedPointCloud& cloud) {
  ASSERT_EQ(cloud.fields.size(), 2u);
  ASSERT_EQ(cloud.fields[0].values.size(), cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    ASSERT_EQ(cloud.fields[0].values[i], height(cloud.points[i]));
    ASSERT_EQ(cloud.colours[i], shade(cloud.points[i]));
  }
}

TEST(CloudArrays, StayWithTheirPointsThroughCleaningAndSorting) {
  OrientedPointCloud cloud = torus(2000);
  for (const Vec3& x : {Vec3(9, 9, 9), cloud.points[3], Vec3(0, 0, 0)}) {  // far, there twice, in the middle
    cloud.points.push_back(x);
    cloud.normals.push_back(Vec3::UnitX());
    cloud.colours.push_back(shade(x));
    for (SampleField& field : cloud.fields) field.values.push_back(height(x));
  }
  sort_in_space(cloud);
  expect_own_fields(cloud);
  EXPECT_LT(clean(cloud).kept.size(), 2003u);
  expect_own_fields(cloud);
  expect_own_fields(picked(cloud, {3, 5, 100}));
  EXPECT_EQ(field_names(cloud), (std::vector<std::string>{"rgb", "height", "constant"}));
  cloud.fields[0].values.pop_back();
  EXPECT_THROW(clean(cloud), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
