// What triangles bound, how thin it is, openings, and pieces that touch.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reconstruct/triangles/body_samples.h"
#include "reconstruct/triangles/body_thickness.h"
#include "reconstruct/triangles/plane_caps.h"
#include "reconstruct/triangles/triangle_body.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "reconstruct/triangles/triangle_tree.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

using test::cube;
using test::moved;
using test::together;
using test::torus;

TriangleMesh stretched(TriangleMesh mesh, const Vec3& by) {
  for (Vec3& x : mesh.V) x = x.cwiseProduct(by);
  return mesh;
}

/// A prism over (0, 0), (10, 0), (10, height): a wedge with a sharp ridge along y.
TriangleMesh wedge(double height) {
  TriangleMesh mesh;
  for (const double y : {0., 20.}) {
    mesh.V.emplace_back(0, y, 0);
    mesh.V.emplace_back(10, y, 0);
    mesh.V.emplace_back(10, y, height);
  }
  mesh.F = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  return mesh;
}

/// Around z from z = 0 to 2, open at both ends.
TriangleMesh open_tube(double radius, int n = 40) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i)
    for (const double z : {0., 2.}) {
      const double u = 2 * std::numbers::pi * i / n;
      mesh.V.emplace_back(radius * std::cos(u), radius * std::sin(u), z);
    }
  for (int i = 0; i < n; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % n);
    mesh.F.push_back({a, b, b + 1});
    mesh.F.push_back({a, b + 1, a + 1});
  }
  return mesh;
}

std::vector<double> thickness_of(const TriangleMesh& mesh, double limit) {
  const TriangleSamples samples = sample_triangles(mesh, .02 * diagonal_of(mesh));
  return sheet_thickness(mesh, TriangleTree(mesh), samples.points, samples.faces, limit);
}

TEST(TriangleBody, HasTheVolumeAndTheGenusOfTheSolid) {
  const TriangleBody box = measure_body(stretched(cube(), {2, 3, 5}));
  EXPECT_NEAR(box.volume, 30, 1e-12);
  EXPECT_NEAR(box.area, 62, 1e-12);
  EXPECT_EQ(box.n_pieces, 1U);
  EXPECT_EQ(box.genus(), 0);
  EXPECT_TRUE(box.is_closed && box.is_manifold);
  EXPECT_EQ(measure_body(test::split(torus(), 0)).genus(), 1);
  const TriangleBody two = measure_body(together(cube(), moved(torus(), {5, 0, 0})));
  EXPECT_EQ(two.n_pieces, 2U);
  EXPECT_EQ(two.genus(), 1);
}

TEST(TriangleBody, OfPiecesThatTouchAlongAnEdgeCountsEach) {
  const TriangleBody body = measure_body(together(cube(), moved(cube(), {1, 1, 0})));
  EXPECT_EQ(body.n_pieces, 2U);
  EXPECT_EQ(body.genus(), 0);
  EXPECT_NEAR(body.volume, 2, 1e-12);
  EXPECT_TRUE(body.is_closed && body.is_manifold);
}

TEST(TriangleBody, OfAnOpenSurfaceSaysThatItIsOpen) {
  TriangleMesh open = cube();
  open.F.pop_back();
  const TriangleBody body = measure_body(open);
  EXPECT_FALSE(body.is_closed);
  EXPECT_FALSE(body.is_manifold);
}

TEST(TriangleTree, FindsWhatAllTrianglesSay) {
  const TriangleMesh mesh = torus();
  const TriangleTree tree(mesh);
  const auto all = [](std::uint32_t) { return true; };
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x(at(random), at(random), at(random));
    double least = 1e300;
    for (std::size_t f = 0; f < mesh.F.size(); ++f)
      least =
          std::min(least, (closest_on_triangle(x, mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)) - x).norm());
    const auto hit = tree.nearest(x, 1e300, all);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, least, 1e-14);
    EXPECT_FALSE(tree.nearest(x, .99 * least, all));
  }
  const auto hit = tree.first_on_ray({0, 0, 0}, Vec3::UnitX(), 0, 10, all);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, .6, .01);
  EXPECT_FALSE(tree.first_on_ray({0, 0, 0}, Vec3::UnitZ(), 0, 10, all));
}

TEST(SheetThickness, OfAPlateIsItsOwn) {
  const std::vector<double> t = thickness_of(stretched(cube(), {100, 60, 1}), 10);
  // All but the four narrow sides.
  EXPECT_GT(std::count_if(t.begin(), t.end(), [](double x) { return std::abs(x - 1) < 1e-9; }), .9 * t.size());
  EXPECT_NEAR(thin_share_of(t, .01), 1, 1e-9);
}

TEST(SheetThickness, RidgesAreNotThin) {
  for (const double height : {1., 3., 5.}) {
    const std::vector<double> t = thickness_of(wedge(height), 100);
    EXPECT_TRUE(std::all_of(t.begin(), t.end(), [](double x) { return !(x < 5); })) << height;
  }
}

TEST(SheetThickness, AGapBetweenTwoPiecesCounts) {
  const std::vector<double> t = thickness_of(together(cube(), moved(cube(), {1.05, 0, 0})), .5);
  EXPECT_NEAR(*std::min_element(t.begin(), t.end()), .05, 1e-9);
}

TEST(BodySamples, AreAsDenseAsTheBodyIsThinAndOnlyThere) {
  const BodySamples plate = sample_body(stretched(cube(), {100, 60, 1}));
  EXPECT_NEAR(plate.report.thickness.value_or(0), 1, 1e-9);
  EXPECT_NEAR(plate.report.least_spacing, 1. / 3, 1e-9);
  EXPECT_GT(plate.cloud.points.size(), 80000U);
  const BodySamples thick = sample_body(cube());
  EXPECT_EQ(thick.report.least_spacing, thick.report.spacing);
  // A fin on a block: the block is sampled as without it.
  const TriangleMesh fin = moved(stretched(cube(), {.02, 1, 1}), {.5, 0, 1.2});
  const BodySamples both = sample_body(together(cube(), fin));
  const auto on_block =
      std::count_if(both.cloud.points.begin(), both.cloud.points.end(), [](const Vec3& x) { return x.z() <= 1; });
  EXPECT_LT(both.report.least_spacing, .7 * both.report.spacing);
  EXPECT_NEAR(static_cast<double>(on_block), 6 / std::pow(both.report.spacing, 2),
              1.2 / std::pow(both.report.spacing, 2));
}

TEST(PlaneCaps, AnOpeningIsClosedByItsPlaneAndIsALabelOfItsOwn) {
  const BodySamples tube = sample_body(open_tube(.5));
  ASSERT_EQ(tube.report.caps.size(), 2U);
  for (const PlaneCap& cap : tube.report.caps) {
    EXPECT_NEAR(std::abs(cap.normal.z()), 1, 1e-12);
    EXPECT_GT(cap.normal.z() * (cap.centre.z() - 1), 0);
    EXPECT_NEAR(cap.area, std::numbers::pi * .25, .01);
  }
  const TriangleBody body = measure_body(tube.boundary);
  EXPECT_TRUE(body.is_closed && body.is_manifold);
  EXPECT_EQ(body.genus(), 0);
  EXPECT_NEAR(body.volume, std::numbers::pi * .5, .01);
  ASSERT_EQ(tube.cloud.labels.size(), tube.cloud.points.size());
  for (std::size_t i = 0; i < tube.cloud.points.size(); ++i) {
    const double z = tube.cloud.points[i].z();
    EXPECT_EQ(tube.cloud.labels[i] > 1, std::abs(tube.cloud.normals[i].z()) > .5);
    if (tube.cloud.labels[i] > 1) EXPECT_TRUE(std::abs(z) < 1e-12 || std::abs(z - 2) < 1e-12);
  }
}

TEST(PlaneCaps, BetweenTwoTubesTheEndsAreRings) {
  const BodySamples pipe = sample_body(together(open_tube(.5), test::inside_out(open_tube(.4))));
  EXPECT_EQ(pipe.report.caps.size(), 4U);
  for (const Vec3& x : pipe.cloud.points) EXPECT_GT(std::hypot(x.x(), x.y()), .39);
}

TEST(PlaneCaps, CornersThatDifferByRoundOffAreNoRims) {
  // A can whose ends have corners of their own, one bit beside those of its side.
  TriangleMesh can = sample_body(open_tube(.5)).boundary;
  for (std::size_t f = 0; f < can.F.size(); ++f) {
    if (std::abs(can.area_vector(f).normalized().z()) < .5) continue;
    for (int& v : can.F[f]) {
      can.V.emplace_back(can.V[v] * (1 + 2e-16));
      v = static_cast<int>(can.V.size()) - 1;
    }
  }
  can.labels.clear();
  const BodySamples body = sample_body(can);
  EXPECT_TRUE(body.report.caps.empty());
  EXPECT_NEAR(measure_body(body.boundary).volume, std::numbers::pi * .5, .01);
}

TEST(PlaneCaps, SheetsAndBallsStayOpen) {
  TriangleMesh sheet = cube();
  sheet.F.resize(2);
  EXPECT_TRUE(cap_plane_rims(sheet, 0).empty());
  TriangleMesh ball = torus();  // a hole whose rim is no plane
  ball.F.erase(ball.F.begin(), ball.F.begin() + 40);
  EXPECT_TRUE(cap_plane_rims(ball, 0).empty());
}

TEST(Touching, PiecesThatMeetAlongAnEdgeArePartedOrJoined) {
  const TriangleMesh two = together(cube(), moved(cube(), {1, 1, 0}));
  for (const Touching touching : {Touching::Apart, Touching::Fuse}) {
    const BodySamples body = sample_body(two, {.touching = touching});
    EXPECT_EQ(body.report.touching.n_pieces, 2U);
    const double w = body.report.touching.width;
    EXPECT_GT(w, 0);
    for (std::size_t i = 0; i < body.cloud.points.size(); ++i) {
      const Vec3& x = body.cloud.points[i];
      const double off = std::hypot(x.x() - 1, x.y() - 1);
      // Neither side has samples at the edge, and those of each quarter stay in it.
      if (x.z() > 0 && x.z() < 1) EXPECT_GT(off, .5 * w);
      EXPECT_NEAR(body.cloud.normals[i].norm(), 1, 1e-12);
      const bool in_quarter = (x.x() - 1) * (x.y() - 1) >= -1e-12;
      if (off < w && x.z() > 2 * w && x.z() < 1 - 2 * w) EXPECT_EQ(in_quarter, touching == Touching::Apart);
    }
  }
}

TEST(Touching, OnePieceTouchesNothing) {
  for (const TriangleMesh& mesh : {cube(), torus(), test::split(torus(), 0)})
    EXPECT_EQ(sample_body(mesh).report.touching.n_contacts, 0U);
}

TEST(BodySamples, RandomTrianglesAreNoBody) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> at(0, 1);
  for (const int n : {20, 100, 1000}) {
    TriangleMesh soup;
    for (int f = 0; f < n; ++f) {
      for (int k = 0; k < 3; ++k) soup.V.emplace_back(at(random), at(random), at(random));
      soup.F.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    EXPECT_THROW(sample_body(soup), NoBody) << n;
  }
  EXPECT_NO_THROW(sample_body(test::some_removed(torus(), .3)));
}

}  // namespace
}  // namespace umtet
