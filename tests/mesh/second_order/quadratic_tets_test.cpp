#include "mesh/second_order/quadratic_tets.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "mesh/second_order/jacobian_bounds.h"
#include "mesh/second_order/second_order_certificate.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

/// A linear mesh of a domain and what is needed to curve it.
struct Linear {
  TetMesh mesh;
  std::vector<Triangle> faces;
  double h;

  Linear(const AnalyticDomain& domain, double edge) : h(edge) {
    UmParams params;
    params.mode = UmMode::Paper;
    params.paper.relaxation_iterations = 5;
    UmResult result = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain, params);
    EXPECT_EQ(result.status, UmStatus::Success) << result.evidence.what;
    mesh = {std::move(result.final), std::move(result.submesh.mesh.C)};
    faces = std::move(result.submesh.positive_faces);
  }
  SecondOrder curved(const AnalyticDomain& domain, const SecondOrderParams& params = {}) const {
    return quadratic_tets(mesh, faces, domain, h, params);
  }
};

SecondOrderCertificate certificate_of(const QuadraticTetMesh& mesh, const AnalyticDomain& domain, double h) {
  SecondOrderInput input;
  input.mesh = &mesh;
  input.h = h;
  input.psi = domain;
  return certify_second_order(input);
}

TEST(QuadraticTets, BoundaryMidSidesAreOnTheSurfaceAndJacobiansPositive) {
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const Linear linear(domain, h_for_tets(domain, domain.box, 4000));
    const SecondOrder result = linear.curved(domain);
    EXPECT_TRUE(std::equal(linear.mesh.V.begin(), linear.mesh.V.end(), result.mesh.V.begin()));
    EXPECT_EQ(2 * result.boundary_mid_sides.size(), 3 * linear.faces.size());
    EXPECT_TRUE(result.off_surface.empty());
    for (const int m : result.boundary_mid_sides) {
      ASSERT_LT(std::abs(domain.value(result.mesh.V[m])), 1e-8 * linear.h * domain.gradient(result.mesh.V[m]).norm());
    }
    const SecondOrderCertificate c = certificate_of(result.mesh, domain, linear.h);
    EXPECT_TRUE(failures(c).empty()) << failures(c).front();
    EXPECT_EQ(c.n_boundary_mid_sides, result.boundary_mid_sides.size());
    EXPECT_EQ(c.n_nodes, result.mesh.V.size());
    EXPECT_GT(c.min_scaled_jacobian_lower, .19);
    EXPECT_GE(c.min_scaled_jacobian_upper, c.min_scaled_jacobian_lower);
    EXPECT_LT(*c.max_mid_side_distance_over_h, 1e-8);
  }
}

/// Exponent of h in an error from the first mesh to the last.
double rate(const std::vector<double>& errors, const std::vector<double>& h) {
  return std::log(errors.front() / errors.back()) / std::log(h.front() / h.back());
}

TEST(QuadraticTets, VolumeErrorFallsAsHToTheFourthAndDistanceAsItsCube) {
  for (const AnalyticDomain& domain : {testing::sphere(), testing::torus()}) {
    SCOPED_TRACE(domain.name);
    const std::vector<double> h = {.25, .15, .09};
    std::vector<double> errors, distances, flat;
    for (const double edge : h) {
      const Linear linear(domain, edge);
      const SecondOrderCertificate c = certificate_of(linear.curved(domain).mesh, domain, edge);
      errors.push_back(std::abs(c.volume - *domain.volume));
      distances.push_back(*c.rms_face_distance_over_h * edge);
      const SecondOrder straight = quadratic_tets(linear.mesh, {}, domain, edge);
      flat.push_back(std::abs(certificate_of(straight.mesh, domain, edge).volume - *domain.volume));
    }
    EXPECT_GT(rate(errors, h), 3.5);
    EXPECT_NEAR(rate(flat, h), 2, .4);
    EXPECT_GT(rate(distances, h), 2.8);
    EXPECT_LT(errors.back(), 1e-4 * *domain.volume);
  }
}

TEST(QuadraticTets, WithoutFacesToCurveItIsTheLinearMesh) {
  const AnalyticDomain ball = testing::sphere();
  const Linear linear(ball, .3);
  const SecondOrder result = quadratic_tets(linear.mesh, {}, ball, linear.h);
  for (const QuadraticTet& tet : result.mesh.C) {
    for (int k = 0; k < 6; ++k) {
      const Vec3 middle = (linear.mesh.V[tet[kMidSideEdge[k][0]]] + linear.mesh.V[tet[kMidSideEdge[k][1]]]) / 2;
      ASSERT_EQ(result.mesh.V[tet[4 + k]], middle);
    }
  }
  EXPECT_TRUE(result.boundary_mid_sides.empty());
  const SecondOrderCertificate c = certificate_of(result.mesh, ball, linear.h);
  EXPECT_NEAR(c.min_scaled_jacobian_lower, 1, 1e-9);
  EXPECT_EQ(c.n_mid_sides_off_surface, c.n_boundary_mid_sides);  // which the certificate does not pass over
  EXPECT_FALSE(failures(c).empty());
}

/// T4 of 160 tets, with handles about an edge thick: a hundred mid-sides have to give way. (With smaller h, up to .66,
/// the handles have double positive faces, and rounding decides whether they can be projected.)
struct Coarse {
  AnalyticDomain domain = testing::banchoff_chmutov_4();
  Linear linear{domain, .72};
};

TEST(QuadraticTets, RelaxedMidSidesMakeRoomOnTheSurface) {
  const Coarse coarse;
  const SecondOrder result = coarse.linear.curved(coarse.domain);
  EXPECT_GT(result.n_slid, 20u);
  EXPECT_GT(result.n_relaxed, 20u);
  EXPECT_TRUE(result.off_surface.empty());
  const SecondOrderCertificate c = certificate_of(result.mesh, coarse.domain, coarse.linear.h);
  EXPECT_TRUE(failures(c).empty()) << failures(c).front();
  EXPECT_GT(c.min_scaled_jacobian_lower, .05);
}

TEST(QuadraticTets, LastOfAllMidSidesGoBackAndAreNamed) {
  const Coarse coarse;
  SecondOrderParams params;
  params.sweeps = 0;
  const SecondOrder result = coarse.linear.curved(coarse.domain, params);
  ASSERT_FALSE(result.off_surface.empty());
  EXPECT_EQ(result.n_slid, 0u);
  const SecondOrderCertificate c = certificate_of(result.mesh, coarse.domain, coarse.linear.h);
  EXPECT_EQ(c.n_nonpositive_jacobians, 0u);
  EXPECT_GT(c.min_scaled_jacobian_lower, params.least);
  EXPECT_EQ(c.n_mid_sides_off_surface, result.off_surface.size());
  EXPECT_TRUE(failures(c, result.off_surface.size()).empty());
  EXPECT_FALSE(failures(c, result.off_surface.size() - 1).empty());
}

TEST(QuadraticTets, DoNotDependOnThreads) {
  const Coarse coarse;
  const auto with_threads = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return coarse.linear.curved(coarse.domain);
  };
  const SecondOrder one = with_threads(1), three = with_threads(3);
  ASSERT_EQ(one.mesh.V.size(), three.mesh.V.size());
  EXPECT_EQ(std::memcmp(one.mesh.V.data(), three.mesh.V.data(), one.mesh.V.size() * sizeof(Vec3)), 0);
  EXPECT_EQ(one.mesh.C, three.mesh.C);
  EXPECT_EQ(one.n_psi_evaluations, three.n_psi_evaluations);
}

TEST(QuadraticTets, RefusesWhatItCannotCurve) {
  const AnalyticDomain ball = testing::sphere();
  const TetMesh tet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}}};
  SecondOrderParams params;
  EXPECT_THROW(quadratic_tets(tet, {{0, 1, 4}}, ball, 1), std::invalid_argument);
  EXPECT_THROW(quadratic_tets(tet, {{0, 1, -1}}, ball, 1), std::invalid_argument);
  EXPECT_THROW(quadratic_tets(tet, {}, ball, 0), std::invalid_argument);
  EXPECT_THROW(quadratic_tets({tet.V, {{0, 1, 2, 5}}}, {}, ball, 1), std::invalid_argument);
  params.least = params.target + .1;
  EXPECT_THROW(quadratic_tets(tet, {}, ball, 1, params), std::invalid_argument);
  params = {};
  params.sweeps = -1;
  EXPECT_THROW(quadratic_tets(tet, {}, ball, 1, params), std::invalid_argument);
}

/// Two tets of second order on either side of a face.
QuadraticTetMesh two_tets() {
  const TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}};
  return quadratic_tets(mesh, {}, testing::sphere(), 1).mesh;
}

TEST(SecondOrderCertificate, SeesTornEdgesAndBrokenJacobians) {
  const auto measured = [](const QuadraticTetMesh& mesh) {
    SecondOrderInput input;
    input.mesh = &mesh;
    input.h = 1;
    return certify_second_order(input);
  };
  QuadraticTetMesh mesh = two_tets();
  SecondOrderCertificate c = measured(mesh);
  EXPECT_TRUE(failures(c).empty());
  EXPECT_NEAR(c.volume, 1. / 6 + 1. / 3, 1e-15);
  EXPECT_EQ(c.n_boundary_mid_sides, 9u);

  const auto shared = std::find(mesh.C[1].begin() + 4, mesh.C[1].end(), mesh.C[0][5]);
  ASSERT_NE(shared, mesh.C[1].end());
  mesh.V.push_back(mesh.V[*shared]);  // the same place, but another node
  *shared = static_cast<int>(mesh.V.size()) - 1;
  c = measured(mesh);
  EXPECT_EQ(c.n_torn_edges, 1u);
  EXPECT_EQ(failures(c).size(), 1u);

  mesh = two_tets();
  std::swap(mesh.C[0][8], mesh.C[0][9]);  // as Gmsh has them
  EXPECT_GT(measured(mesh).n_nonpositive_jacobians, 0u);
  EXPECT_GT(measured(mesh).n_torn_edges, 0u);

  mesh = two_tets();
  mesh.V[mesh.C[0][6]] += Vec3(.6, 0, 0);
  c = measured(mesh);
  EXPECT_GE(c.n_nonpositive_jacobians, 1u);
  EXPECT_LE(c.min_scaled_jacobian_lower, 0);
  EXPECT_FALSE(failures(c).empty());
}

}  // namespace
}  // namespace umtet
