#include "body/edges/triangle_domain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "body/edges/feature_sizes.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/tet_quality.h"
#include "mesh/features/feature_measures.h"
#include "mesh/features/piecewise_mesh.h"
#include "reconstruct/triangles/triangle_tree.h"
#include "reconstruct/triangles/triangle_winding.h"
#include "tests/reconstruct/triangles/solids.h"
#include "tests/support/piecewise_bodies.h"

namespace umtet {
namespace {

using testing::Placement;
using testing::random_placement;

TriangleMesh cylinder(int n) {
  std::vector<Eigen::Vector2d> circle;
  for (int k = 0; k < n; ++k) circle.emplace_back(std::cos(2 * M_PI * k / n), std::sin(2 * M_PI * k / n));
  return test::prism(circle, 1.5);
}

/// With a concave edge: an L. The fan from the inner corner stays inside.
TriangleMesh ell() { return test::prism({{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}}, 1); }

TriangleMesh placed(TriangleMesh mesh, const Placement& at) {
  for (Vec3& x : mesh.V) x = at.rotation * x + at.offset;
  return mesh;
}

double volume_of(const TriangleMesh& mesh) {
  double v = 0;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) v += mesh.centroid(f).dot(mesh.area_vector(f)) / 3;
  return v;
}

Box box_around(const TriangleMesh& mesh, double margin) {
  Box box;
  for (const Vec3& x : mesh.V) box.extend(x);
  return {box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin)};
}

struct Law {
  const char* name;
  TriangleMesh mesh;
  double h;
  std::size_t curves, corners;
  double volume_tolerance;
  double least_quality = .75;
};

/// A mesh has every curve and corner of the triangles, and their volume.
void expect_all_features(const Law& law, const TriangleMesh& mesh) {
  const SharpEdges edges = find_sharp_edges(mesh);
  const std::optional<TriangleDomain> body = triangle_domain(mesh, edges);
  ASSERT_TRUE(body);
  EXPECT_EQ(body->graph.curves.size(), law.curves);
  EXPECT_EQ(body->graph.corners.size(), law.corners);
  const BackgroundMesh background(a15(), box_around(mesh, 4 * law.h), law.h);
  const PiecewiseMesh made = make_piecewise_mesh(body->domain, background, {}, {}, &body->graph);
  ASSERT_EQ(made.status, UmStatus::Success);
  for (const FeatureDefect& d : made.defects) ADD_FAILURE() << to_string(d.kind) << " at " << d.where.transpose();
  const FeatureMeasures m = measure_features(body->domain, made);
  EXPECT_EQ(m.n_missed_corners + m.n_missed_curves + m.n_faces_without_patch, 0u)
      << m.n_missed_corners << " corners, " << m.n_missed_curves << " curves, " << m.n_faces_without_patch << " faces";
  EXPECT_EQ(m.missed_length, 0);
  EXPECT_LE(m.farthest_vertex, 1e-8);
  EXPECT_GT(m.least_cosine, .9);
  CertificateInput input;
  input.mesh = &made.mesh;
  input.positive_faces = &made.faces;
  const MeshCertificate certificate = certify(input);
  EXPECT_TRUE(certificate.is_embedded());
  double volume = 0, least = 1;
  for (const Tet& t : made.mesh.C) {
    volume += volume6(made.mesh.V[t[0]], made.mesh.V[t[1]], made.mesh.V[t[2]], made.mesh.V[t[3]]) / 6;
    least = std::min(least, mean_ratio(made.mesh, t));
  }
  const double given = volume_of(mesh);
  EXPECT_NEAR(volume, given, law.volume_tolerance * given);
  EXPECT_GE(least, law.least_quality);
}

TEST(TriangleDomain, MeshesHaveEveryEdgeInAnyPosition) {
  const Law laws[] = {{"cube", test::cube(), .11, 12, 8, 1e-12},
                      {"ell", ell(), .17, 18, 12, 1e-12},
                      {"cylinder", cylinder(48), .2, 2, 0, .01}};
  for (const Law& law : laws) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(std::string(law.name) + " " + std::to_string(seed));
      expect_all_features(law, placed(law.mesh, random_placement(seed, law.h)));
    }
  }
}

TEST(TriangleDomain, MeshesHaveFlatBordersAndLines) {
  TriangleMesh imprint = test::cube_with_imprint();
  TriangleMesh open = imprint;
  open.labels.clear();
  open.lines = {{8, 9}, {9, 10}};  // ends in the side
  TriangleMesh cross = imprint;    // four curves meet in the middle of a side
  cross.F.resize(cross.F.size() - 2);
  cross.labels.clear();
  cross.V.emplace_back(.5, .5, 1);
  for (int k = 0; k < 4; ++k) {
    cross.F.push_back({8 + k, 8 + (k + 1) % 4, 12});
    cross.lines.push_back({8 + k, 12});
  }
  // A border along a cylinder, and one across it.
  TriangleMesh half = cylinder(48);
  for (std::size_t f = 0; f < half.F.size(); ++f) half.labels.push_back(half.centroid(f).y() > 0 ? 2 : 1);
  // A face between two flat curves that meet is on either patch as far as its strata show, and no flip changes it: the
  // least Q of the imprint is .71 in 4 of 18 positions.
  const Law laws[] = {{"imprint", imprint, .08, 16, 12, 1e-12, .7},
                      {"open", open, .08, 14, 11, 1e-12},
                      {"cross", cross, .08, 16, 13, 1e-12},
                      {"half", half, .2, 8, 4, .01}};
  for (const Law& law : laws) {
    for (unsigned seed = 0; seed < 2; ++seed) {
      SCOPED_TRACE(std::string(law.name) + " " + std::to_string(seed));
      expect_all_features(law, placed(law.mesh, random_placement(seed, law.h)));
    }
  }
}

TEST(TriangleDomain, PsiHasTheSignOfTheWindingNumberAndIsADistance) {
  for (const TriangleMesh& mesh :
       {placed(ell(), random_placement(5, 1)), placed(cylinder(12), random_placement(6, 1))}) {
    const auto body = triangle_domain(mesh, find_sharp_edges(mesh));
    ASSERT_TRUE(body);
    const TriangleWinding winding(mesh);
    const TriangleTree tree(mesh);
    std::mt19937 random(1);
    const Box box = box_around(mesh, .5);
    int n_inside = 0;
    for (int k = 0; k < 3000; ++k) {
      Vec3 x;
      for (int a = 0; a < 3; ++a)
        x[a] = box.min()[a] + box.sizes()[a] * static_cast<double>(random()) / static_cast<double>(random.max());
      const double psi = body->domain.value(x), distance = tree.nearest(x).distance;
      if (distance < 1e-3) continue;
      EXPECT_EQ(psi<0, winding(x)> .5) << x.transpose();
      EXPECT_LE(std::abs(psi), distance + 1e-9);
      n_inside += psi < 0 ? 1 : 0;
    }
    EXPECT_GT(n_inside, 100);
  }
}

TEST(TriangleDomain, FineFacetsOfACylinderAreOneAndCoarseOnesStay) {
  const auto fine = triangle_domain(cylinder(96), find_sharp_edges(cylinder(96)));
  const auto coarse = triangle_domain(cylinder(12), find_sharp_edges(cylinder(12)));
  ASSERT_TRUE(fine && coarse);
  // At the middle of a facet.
  const auto value_at_middle = [](const TriangleDomain& body, int n) {
    const double a = M_PI / n, r = std::cos(a);
    return body.domain.value(Vec3(r * std::cos(a), r * std::sin(a), .7));
  };
  EXPECT_NEAR(value_at_middle(*fine, 96), std::cos(M_PI / 96) - 1, 1e-9);
  EXPECT_NEAR(value_at_middle(*coarse, 12), 0, 1e-12);
  // The rim of the fine one is a circle, that of the coarse one has chords.
  for (const Vec3& x : fine->graph.curves[0].points) EXPECT_NEAR(x.head<2>().norm(), 1, 1e-9);
  double least = 1;
  for (const Vec3& x : coarse->graph.curves[0].points) least = std::min(least, x.head<2>().norm());
  EXPECT_NEAR(least, std::cos(M_PI / 12), 1e-9);
}

TEST(TriangleDomain, AnOpenSurfaceIsNone) {
  TriangleMesh mesh = test::cube();
  mesh.F.pop_back();
  EXPECT_FALSE(triangle_domain(mesh, find_sharp_edges(mesh)));
}

TEST(FeatureSizes, FollowThicknessAndCurves) {
  // A plate of .05.
  TriangleMesh plate = test::prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, .05);
  const SharpEdges edges = find_sharp_edges(plate);
  const auto body = triangle_domain(plate, edges);
  ASSERT_TRUE(body);
  const FeatureSizeParams params{.h = .2, .h_min = .001, .edges_across = 2, .deviation = 1};
  for (const SizeSource& s : feature_sizes(plate, edges, body->graph, body->curvature, params)) {
    const bool is_on_rim = s.x.z() > 1e-9 && s.x.z() < .05 - 1e-9;
    if (!is_on_rim) EXPECT_NEAR(s.h, .025, 1e-9) << s.x.transpose();
  }
  const TriangleMesh cube = test::cube();
  const auto thick = triangle_domain(cube, find_sharp_edges(cube));
  for (const SizeSource& s : feature_sizes(cube, find_sharp_edges(cube), thick->graph, thick->curvature, params))
    EXPECT_EQ(s.h, .2);
  // Around a cylinder of radius 1: sqrt(8 d R).
  const TriangleMesh round = cylinder(96);
  const auto turned = triangle_domain(round, find_sharp_edges(round));
  for (const bool is_known : {true, false}) {
    const std::vector<double> curvature = is_known ? turned->curvature : std::vector<double>();
    double least = 1;
    for (const SizeSource& s : feature_sizes(round, find_sharp_edges(round), turned->graph, curvature,
                                             {.h = .5, .h_min = .01, .deviation = .002}))
      least = std::min(least, s.h);
    EXPECT_NEAR(least, std::sqrt(8 * .002), is_known ? 1e-9 : .05);
  }
}

}  // namespace
}  // namespace umtet
