#include "reconstruct/triangles/body_samples.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

using test::cube;
using test::inside_out;
using test::moved;
using test::together;
using test::torus;

double off_torus(const Vec3& x) { return std::hypot(std::hypot(x.x(), x.y()) - 1, x.z()) - .4; }
Vec3 torus_normal(const Vec3& x) {
  const double r = std::hypot(x.x(), x.y());
  return Vec3(x.x() * (1 - 1 / r), x.y() * (1 - 1 / r), x.z()).normalized();
}

TEST(TriangleSamples, AreAsManyAsTheSpacingSaysAndKeepTheirDistance) {
  const double spacing = .05;
  const TriangleSamples samples = sample_triangles(torus(), spacing);
  const double expected = 4 * std::numbers::pi * std::numbers::pi * .4 / (spacing * spacing);
  EXPECT_NEAR(static_cast<double>(samples.points.size()) / expected, 1, .2);
  const NeighbourTree tree(samples.points);
  for (const Vec3& x : samples.points) {
    std::size_t n = 0;
    tree.within(x, std::pow(.73 * spacing, 2), [&](std::uint32_t, double) { ++n; });
    EXPECT_EQ(n, 1U);  // itself
  }
  EXPECT_EQ(sample_triangles(torus(), spacing).points, samples.points);
  EXPECT_NE(sample_triangles(torus(), spacing, 1).points, samples.points);
}

TEST(TriangleSamples, BothSidesOfAThinPlateAreSampledAlike) {
  TriangleMesh plate = cube();
  for (Vec3& x : plate.V) x.z() *= .001;
  const TriangleSamples samples = sample_triangles(plate, .05);
  const auto above =
      std::count_if(samples.points.begin(), samples.points.end(), [](const Vec3& x) { return x.z() > .0009; });
  EXPECT_NEAR(static_cast<double>(above) / static_cast<double>(samples.points.size()), .5, .05);
}

TEST(TriangleSamples, NoAreaAndNoSpacingAreRefused) {
  EXPECT_THROW(sample_triangles(TriangleMesh{}, 1), std::invalid_argument);
  for (const double spacing : {0., -1., 1e-9}) EXPECT_THROW(sample_triangles(cube(), spacing), std::invalid_argument);
}

/// The laws of every soup that is a torus: all samples on it, outward, no part of it without samples.
void expect_torus(const TriangleMesh& soup, double tolerance, double least_share = .9) {
  const BodySamples body = sample_body(soup);
  EXPECT_GT(static_cast<double>(body.cloud.points.size()), least_share * static_cast<double>(body.report.n_samples));
  std::size_t n_turned = 0;
  for (std::size_t i = 0; i < body.cloud.points.size(); ++i) {
    const Vec3& x = body.cloud.points[i];
    EXPECT_LT(std::abs(off_torus(x)), tolerance);
    n_turned += body.cloud.normals[i].dot(torus_normal(x)) < 0 ? 1 : 0;
  }
  EXPECT_EQ(n_turned, 0U);
  const NeighbourTree tree(body.cloud.points);
  for (int i = 0; i < 1000; ++i) {
    const double u = 2.4 * i, v = .7 * i, r = 1 + .4 * std::cos(v);
    std::array<Neighbour, 1> room;
    const Vec3 x(r * std::cos(u), r * std::sin(u), .4 * std::sin(v));
    EXPECT_LT((body.cloud.points[tree.k_nearest(x, room).front().point] - x).norm(), .2);
  }
}

TEST(BodySamples, OfMendedSoupsAreThoseOfTheBody) {
  const double jitter = 1e-4 * diagonal_of(torus());
  expect_torus(torus(), .01, 1 - 1e-9);
  expect_torus(test::split(torus(), 0), .01, 1 - 1e-9);
  expect_torus(test::some_turned(torus(), .1), .01, 1 - 1e-9);
  expect_torus(test::some_removed(torus(), .05), .01, 1 - 1e-9);
  expect_torus(test::split(torus(), jitter), .012);
  expect_torus(test::some_removed(test::split(test::some_turned(torus(), .1), jitter), .05), .012);
}

TEST(BodySamples, WhatIsInsideOfAnOverlapIsLeftOut) {
  const TriangleMesh two = together(cube(), moved(cube(), {.5, .25, .25}));
  const BodySamples body = sample_body(two);
  for (const Vec3& x : body.cloud.points) {
    const bool in_first = x.minCoeff() > 1e-4 && x.maxCoeff() < 1 - 1e-4;
    const Vec3 y = x - Vec3(.5, .25, .25);
    EXPECT_FALSE(in_first || (y.minCoeff() > 1e-4 && y.maxCoeff() < 1 - 1e-4));
  }
  // Of the area of 12, .5 * .75 * .75 deep: two faces of .75^2 and 8 of .5 * .75 are inside.
  EXPECT_NEAR(static_cast<double>(body.report.n_inside) / static_cast<double>(body.report.n_samples),
              (2 * .5625 + 4 * .375) / 12, .02);
  // Of each cube one side is wholly inside or cut, its opposite is not.
  EXPECT_GT(std::count(body.boundary.labels.begin(), body.boundary.labels.end(), 0), 0);
  EXPECT_GT(std::count(body.boundary.labels.begin(), body.boundary.labels.end(), 1), 0);
  EXPECT_LT(body.report.unsure, .001);
}

TEST(BodySamples, FacesThatCoincideStay) {
  const BodySamples body = sample_body(together(cube(), moved(cube(), {.5, 0, 0})));
  // x = 0 and x = 1.5, and four sides of 1.5; the copy is off by half an edge, so no triangle is a duplicate.
  const auto at_side =
      std::count_if(body.cloud.points.begin(), body.cloud.points.end(), [](const Vec3& x) { return x.y() < 1e-9; });
  EXPECT_GT(at_side, 0);
  for (const Vec3& x : body.cloud.points) EXPECT_FALSE(std::abs(x.x() - 1) < 1e-9 || std::abs(x.x() - .5) < 1e-9);
}

TEST(BodySamples, InnerWallsAreLeftOut) {
  TriangleMesh wall;  // across the tube
  wall.V = {{.8, 0, -.2}, {1.2, 0, -.2}, {1.2, 0, .2}, {.8, 0, .2}};
  wall.F = {{0, 1, 2}, {0, 2, 3}};
  for (const double gaps : {0., .05}) {
    const BodySamples body = sample_body(together(test::some_removed(torus(), gaps), wall));
    for (const Vec3& x : body.cloud.points) EXPECT_GT(off_torus(x), -.02);
    EXPECT_GT(body.report.n_inside, 0U);
    EXPECT_GT(body.report.unsure, 0);  // the winding number before the wall is 1/2 and more
  }
}

TEST(BodySamples, LabelsAreThoseOfTheTriangles) {
  TriangleMesh mesh = cube();
  for (std::size_t f = 0; f < mesh.F.size(); ++f) mesh.labels.push_back(mesh.centroid(f).z() > .99 ? 2 : 1);
  const BodySamples body = sample_body(mesh);
  ASSERT_EQ(body.cloud.labels.size(), body.cloud.points.size());
  for (std::size_t i = 0; i < body.cloud.points.size(); ++i)
    EXPECT_EQ(body.cloud.labels[i], body.cloud.normals[i].z() > .5 ? 2 : 1);
  for (std::size_t f = 0; f < body.boundary.F.size(); ++f) {
    EXPECT_FALSE(is_partly_inside(body.boundary.labels[f]));
    EXPECT_EQ(group_of(body.boundary.labels[f]), body.boundary.centroid(f).z() > .99 ? 2 : 1);
  }
}

TEST(BodySamples, TrianglesOnTheBoundaryKeepTheirGroupAndLines) {
  TriangleMesh two = together(cube(), test::moved(cube(), {.5, .2, .3}));  // overlapping
  for (std::size_t f = 0; f < two.F.size(); ++f) two.labels.push_back(f < 12 ? 0 : 7);
  two.lines = {{0, 4}, {8, 12}};
  const TriangleMesh kept = sample_body(two).boundary;
  std::size_t n_partly = 0;
  for (std::size_t f = 0; f < kept.F.size(); ++f) {
    const bool is_second = kept.centroid(f).x() > 1 || kept.centroid(f).y() > 1 || kept.centroid(f).z() > 1;
    if (is_second) EXPECT_EQ(group_of(kept.labels[f]), 7);
    n_partly += is_partly_inside(kept.labels[f]) ? 1 : 0;
  }
  EXPECT_GT(n_partly, 0U);
  ASSERT_EQ(kept.lines.size(), 2U);
  EXPECT_EQ(kept.V[kept.lines[1][0]], two.V[8]);
  EXPECT_EQ(kept.V[kept.lines[1][1]], two.V[12]);
  // Without labels, and with a label for each of many triangles, there are no groups.
  TriangleMesh many = torus();
  for (const int label : sample_body(many).boundary.labels) EXPECT_EQ(group_of(label), 0);
  for (std::size_t f = 0; f < many.F.size(); ++f) many.labels.push_back(static_cast<int>(f) + 1);
  for (const int label : sample_body(many).boundary.labels) EXPECT_EQ(group_of(label), 0);
}

TEST(BodySamples, DoNotDependOnTheNumberOfThreads) {
  const TriangleMesh soup = test::some_removed(test::split(test::some_turned(torus(), .1), 1e-4), .05);
  const BodySamples many = sample_body(soup);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const BodySamples few = sample_body(soup);
  EXPECT_EQ(few.cloud.points, many.cloud.points);
  EXPECT_EQ(few.cloud.normals, many.cloud.normals);
  EXPECT_EQ(few.boundary.F, many.boundary.F);
}

TEST(BodySamples, CanBeCancelledOnTheWay) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  int polls = 0;
  const Context counting{.cancelled = [&] { return ++polls, false; }};
  sample_body(torus(), {}, counting);
  const int all = polls;
  EXPECT_GT(all, 20);
  for (const int after : {1, all / 2, all}) {
    polls = 0;
    EXPECT_THROW(sample_body(torus(), {}, {.cancelled = [&] { return ++polls == after; }}), Cancelled);
  }
}

TEST(BodySamples, TheSpacingFollowsSizeAndDetail) {
  EXPECT_NEAR(default_spacing(cube()), .006 * std::sqrt(3.), 1e-12);
  EXPECT_LT(default_spacing(torus(480, 240)), .5 * default_spacing(torus()));
  EXPECT_THROW(sample_body(cube(), {.spacing = -1}), std::invalid_argument);
  EXPECT_THROW(sample_body(TriangleMesh{}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
