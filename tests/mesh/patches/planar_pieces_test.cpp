#include "mesh/patches/planar_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/io/solver_mesh.h"
#include "mesh/patches/patches.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

/// max(s, 0)^3: C2, so that sums of it are flat where all but one of them are 0.
double cubed(double s) { return s > 0 ? s * s * s : 0; }
double slope(double s) { return s > 0 ? 3 * s * s : 0; }

/// A cube with faces |x_i| = 1, where the others are below 1 - r, and round edges.
struct RoundedCube {
  double r;
  double value(const Vec3& x) const {
    double sum = -r * r * r;
    for (const double s : x) sum += cubed(std::abs(s) - 1 + r);
    return sum;
  }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    for (int k = 0; k < 3; ++k) g[k] = std::copysign(slope(std::abs(x[k]) - 1 + r), x[k]);
    return g;
  }
};

/// The solid of revolution of a rounded square: two flat ends and a cylinder.
struct RoundedCylinder {
  double r;
  double value(const Vec3& x) const {
    return cubed(std::hypot(x.x(), x.y()) - 1 + r) + cubed(std::abs(x.z()) - 1 + r) - r * r * r;
  }
  Vec3 gradient(const Vec3& x) const {
    const double rho = std::hypot(x.x(), x.y()), s = rho > 0 ? slope(rho - 1 + r) / rho : 0;
    return {s * x.x(), s * x.y(), std::copysign(slope(std::abs(x.z()) - 1 + r), x.z())};
  }
};

SolverMesh meshed(ImplicitFunctionRef psi, double h) {
  const UmResult made = universal_mesh(BackgroundMesh(a15(), testing::cube_box(1.4), h), psi, {.mode = UmMode::Paper});
  EXPECT_EQ(made.status, UmStatus::Success);
  return solver_mesh(TetMesh{made.final, made.submesh.mesh.C});
}

double least_area(const SolverMesh& mesh) {
  const std::vector<double> area = face_geometry(mesh.nodes, mesh.triangles()).area;
  return 20 * std::accumulate(area.begin(), area.end(), 0.) / static_cast<double>(area.size());
}

TEST(PlanarPieces, ARoundedCubeHasSixPlanesAndARest) {
  const RoundedCube psi{.4};
  const SolverMesh mesh = meshed(psi, .13);
  const std::vector<int> angular = smooth_pieces(mesh.nodes, mesh.triangles(), 20);
  EXPECT_EQ(*std::max_element(angular.begin(), angular.end()), 0)
      << "an angle between neighbours leaks round the edges";
  const std::vector<int> plane = planar_pieces(mesh.nodes, mesh.triangles(), 5, least_area(mesh));
  ASSERT_EQ(*std::max_element(plane.begin(), plane.end()), 5);
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  std::vector<Vec3> area(7, Vec3::Zero());
  double rest = 0;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    area[plane[f] + 1] += faces.area[f] * faces.normal[f];
    if (plane[f] < 0) rest += faces.area[f];
    // The flat part whole, and nothing beyond the angle.
    const bool flat = (faces.centroid[f].cwiseAbs().array() > .6).count() == 1;
    EXPECT_TRUE(!flat || plane[f] >= 0) << faces.centroid[f].transpose();
    EXPECT_TRUE(plane[f] < 0 || faces.normal[f].cwiseAbs().maxCoeff() > std::cos(6 * 3.1416 / 180));
  }
  for (int p = 0; p < 6; ++p) {
    EXPECT_GT(area[p + 1].norm(), 1.2 * 1.2 - .02);
    EXPECT_LT(area[p + 1].norm(), 1.7 * 1.7);
    for (int q = 0; q < p; ++q) EXPECT_LT(area[p + 1].normalized().dot(area[q + 1].normalized()), .1);
  }
  EXPECT_GT(rest, 3);
}

TEST(PlanarPieces, WhatBendsEvenlyIsNoPlane) {
  const RoundedCylinder psi{.25};
  for (const double h : {.2, .12}) {
    const SolverMesh mesh = meshed(psi, h);
    for (const double angle : {3., 8.}) {
      const std::vector<int> plane = planar_pieces(mesh.nodes, mesh.triangles(), angle, least_area(mesh));
      EXPECT_EQ(*std::max_element(plane.begin(), plane.end()), 1) << h << ' ' << angle;
      const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
      for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
        EXPECT_TRUE(plane[f] < 0 || std::abs(faces.normal[f].z()) > .9);
      }
    }
  }
  const SolverMesh ball = meshed(testing::sphere(), .12);
  const std::vector<int> none = planar_pieces(ball.nodes, ball.triangles(), 6, least_area(ball));
  EXPECT_EQ(*std::max_element(none.begin(), none.end()), -1);
}

TEST(PlanarPieces, ABoxIsAllPlanesTheLargestFirst) {
  // Two by four by four cubes.
  const SolverMesh mesh = solver_mesh(testing::cubes(4, [](int i, int, int) { return i < 2; }));
  const std::vector<int> plane = planar_pieces(mesh.nodes, mesh.triangles(), 5, 1);
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    EXPECT_EQ(plane[f]<2, std::abs(faces.normal[f].x())> .5);
    for (std::size_t g = 0; g < f; ++g) EXPECT_EQ(plane[f] == plane[g], faces.normal[f].dot(faces.normal[g]) > .5);
  }
  const std::vector<int> large = planar_pieces(mesh.nodes, mesh.triangles(), 5, 10);  // four sides have an area of 8
  EXPECT_EQ(*std::max_element(large.begin(), large.end()), 1);
  EXPECT_EQ(*std::min_element(large.begin(), large.end()), -1);
  EXPECT_THROW(planar_pieces(mesh.nodes, mesh.triangles(), 0, 1), std::invalid_argument);
  EXPECT_THROW(planar_pieces(mesh.nodes, mesh.triangles(), 90, 1), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
