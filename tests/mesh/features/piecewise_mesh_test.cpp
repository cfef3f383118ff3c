#include "mesh/features/piecewise_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesh/certify/certificate.h"
#include "mesh/core/boundary_strata.h"
#include "mesh/core/tet_quality.h"
#include "mesh/features/feature_measures.h"
#include "tests/support/piecewise_bodies.h"

namespace umtet {
namespace {

using testing::piecewise_body;
using testing::PiecewiseBody;
using testing::Placement;
using testing::random_placement;

constexpr double kH = 2. / 9;

/// UMTET_PLACEMENTS sets the number of positions of each body.
unsigned n_placements() {
  const char* n = std::getenv("UMTET_PLACEMENTS");
  return n ? static_cast<unsigned>(std::max(1, std::atoi(n))) : 5;
}

BackgroundMesh background_of(const PiecewiseBody& body, double h) {
  const double R = body.radius + 4 * h;
  return BackgroundMesh(a15(), Box(Vec3::Constant(-R), Vec3::Constant(R)), h);
}

double least_quality(const TetMesh& mesh) {
  double least = 1;
  for (const Tet& t : mesh.C) least = std::min(least, mean_ratio(mesh, t));
  return least;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.C) sum += volume6(mesh.V[t[0]], mesh.V[t[1]], mesh.V[t[2]], mesh.V[t[3]]) / 6;
  return sum;
}

/// The patches on both sides of each boundary edge, ascending.
std::map<std::pair<int, int>, std::vector<int>> sides_of_edges(const PiecewiseMesh& made) {
  std::map<std::pair<int, int>, std::vector<int>> sides;
  for (std::size_t f = 0; f < made.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(made.faces[f][k], made.faces[f][(k + 1) % 3]);
      sides[{a, b}].push_back(made.face_patch[f]);
    }
  }
  for (auto& [edge, patches] : sides) std::sort(patches.begin(), patches.end());
  return sides;
}

void expect_curves_are_covered(const PiecewiseMesh& made) {
  const auto sides = sides_of_edges(made);
  std::size_t n_edges = 0;
  for (std::size_t c = 0; c < made.graph.curves.size(); ++c) {
    const FeatureCurve& curve = made.graph.curves[c];
    const std::vector<int>& chain = made.chains[c];
    ASSERT_GE(chain.size(), 2U);
    if (curve.is_closed()) {
      EXPECT_EQ(chain.front(), chain.back());
    } else {
      EXPECT_EQ(chain.front(), made.corner_vertex[curve.ends[0]]);
      EXPECT_EQ(chain.back(), made.corner_vertex[curve.ends[1]]);
    }
    double length = 0;
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
      const auto [a, b] = std::minmax(chain[k], chain[k + 1]);
      const auto at = sides.find({a, b});
      ASSERT_NE(at, sides.end()) << "not an edge of the boundary";
      EXPECT_EQ(at->second, std::vector<int>(curve.patches.begin(), curve.patches.end()));
      length += (made.mesh.V[a] - made.mesh.V[b]).norm();
      ++n_edges;
    }
    // Chords of 2 h on circles of radius 4 h are 1 % shorter than their arcs.
    EXPECT_NEAR(length, curve.length(), curve.is_closed() ? .03 * curve.length() : .01 * curve.length());
  }
  // No other edge is between two patches.
  const auto n_between = static_cast<std::size_t>(
      std::count_if(sides.begin(), sides.end(), [](const auto& e) { return e.second.front() != e.second.back(); }));
  EXPECT_EQ(n_between, n_edges);
}

void expect_vertices_and_faces_on_their_strata(const PiecewiseBody& body, const PiecewiseMesh& made) {
  const BoundaryStrata strata(body.domain, made.strata);
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v) {
    if (made.stratum[v] < 0) continue;
    const std::vector<int>& patches = made.strata[made.stratum[v]].patches;
    ASSERT_FALSE(patches.empty());
    for (const int p : patches) {
      Vec3 g;
      const double f = strata.value(p, made.mesh.V[v], &g);
      EXPECT_LE(std::abs(f), 1e-8 * kH * g.norm());
    }
  }
  for (std::size_t f = 0; f < made.faces.size(); ++f) {
    ASSERT_GE(made.face_patch[f], 0);
    const Vec3 &a = made.mesh.V[made.faces[f][0]], &b = made.mesh.V[made.faces[f][1]],
               &c = made.mesh.V[made.faces[f][2]];
    Vec3 g;
    strata.value(made.face_patch[f], (a + b + c) / 3, &g);
    const Vec3 normal = (b - a).cross(c - a);
    EXPECT_GT(normal.dot(g), .9 * normal.norm() * g.norm());
  }
}

struct Law {
  const char* body;
  double least_quality;
};

class PiecewiseMeshes : public ::testing::TestWithParam<Law> {};

// The table of least Q by body that the test prints is the measurement.
TEST_P(PiecewiseMeshes, HaveEveryCurveAndGoodTetsInAnyPosition) {
  std::vector<double> least;
  for (unsigned seed = 0; seed < n_placements(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const PiecewiseBody body = piecewise_body(GetParam().body, random_placement(seed, kH));
    const PiecewiseMesh made = make_piecewise_mesh(body.domain, background_of(body, kH));
    ASSERT_EQ(made.status, UmStatus::Success);
    for (const FeatureDefect& d : made.defects) ADD_FAILURE() << to_string(d.kind) << " at " << d.where.transpose();
    ASSERT_EQ(made.graph.corners.size(), static_cast<std::size_t>(body.corners));
    ASSERT_EQ(made.graph.curves.size(), static_cast<std::size_t>(body.curves));
    expect_curves_are_covered(made);
    expect_vertices_and_faces_on_their_strata(body, made);

    const FeatureMeasures features = measure_features(body.domain, made);
    EXPECT_EQ(features.n_missed_corners + features.n_missed_curves + features.n_faces_without_patch, 0U);
    EXPECT_EQ(features.missed_length, 0);
    EXPECT_NEAR(features.length, body.curve_length, .01 * body.curve_length);
    EXPECT_LE(features.farthest_vertex, 1e-8);
    EXPECT_LE(features.worst_angle_deg, body.has_flat_faces ? 1e-6 : 20);
    EXPECT_LE(features.farthest_point, body.has_flat_faces ? 1e-8 : .2);
    EXPECT_GT(features.least_cosine, .9);

    CertificateInput input;
    input.mesh = &made.mesh;
    input.positive_faces = &made.faces;
    const MeshCertificate certificate = certify(input);
    EXPECT_TRUE(certificate.is_embedded());
    EXPECT_EQ(certificate.boundary.equals_positive_faces, true);
    EXPECT_EQ(certificate.boundary.euler_characteristic, 2);
    EXPECT_EQ(certificate.boundary.components, 1);
    EXPECT_GT(certificate.quality.dihedral_min_deg, 28);
    EXPECT_LT(certificate.quality.dihedral_max_deg, 128);
    EXPECT_NEAR(volume(made.mesh), body.volume, (body.has_flat_faces ? 1e-10 : .04) * body.volume);
    least.push_back(least_quality(made.mesh));
  }
  std::sort(least.begin(), least.end());
  std::printf("  %-9s least Q: min %.3f, median %.3f of %zu positions\n", GetParam().body, least.front(),
              least[least.size() / 2], least.size());
  EXPECT_GE(least.front(), GetParam().least_quality);
}

INSTANTIATE_TEST_SUITE_P(Bodies, PiecewiseMeshes,
                         ::testing::Values(Law{"cube", .77}, Law{"cylinder", .77}, Law{"L", .75}, Law{"lens", .78},
                                           Law{"balls", .78}, Law{"cube-ball", .76}, Law{"wedge60", .72},
                                           Law{"wedge45", .70}),
                         [](const auto& law) {
                           std::string name = law.param.body;
                           std::erase(name, '-');
                           return name;
                         });

TEST(PiecewiseMesh, ThreadsDoNotChangeAByte) {
  const PiecewiseBody body = piecewise_body("cube-ball", random_placement(3, kH));
  const BackgroundMesh background = background_of(body, kH);
  std::vector<PiecewiseMesh> made;
  for (const std::size_t n : {1, 2, 4}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n);
    made.push_back(make_piecewise_mesh(body.domain, background));
  }
  for (std::size_t k = 1; k < made.size(); ++k) {
    EXPECT_EQ(made[k].mesh.C, made[0].mesh.C);
    EXPECT_EQ(made[k].mesh.V, made[0].mesh.V);
    EXPECT_EQ(made[k].chains, made[0].chains);
    EXPECT_EQ(made[k].face_patch, made[0].face_patch);
  }
}

TEST(PiecewiseMesh, ADomainOfOnePatchHasNoFeatures) {
  const PiecewiseBody body{"ball", testing::ball_at({}, Vec3::Zero(), 1), 1, 0, false, 0, 0, 0, 0};
  const PiecewiseMesh made = make_piecewise_mesh(body.domain, background_of(body, kH));
  ASSERT_EQ(made.status, UmStatus::Success);
  EXPECT_TRUE(made.graph.curves.empty());
  EXPECT_TRUE(made.defects.empty());
  EXPECT_GE(least_quality(made.mesh), .79);
  EXPECT_TRUE(std::all_of(made.face_patch.begin(), made.face_patch.end(), [](int p) { return p == 0; }));
}

// A groove far thinner than h cannot be embedded.
TEST(PiecewiseMesh, CurvesThatCannotBeEmbeddedAreNamedAndTheMeshIsValid) {
  const Placement at = random_placement(2, kH);
  const PiecewiseBody cube = piecewise_body("cube", at);
  const PiecewiseDomain groove = intersection(
      intersection(testing::half_space(at, {1, 0, 0}, .02 * kH), testing::half_space(at, {-1, 0, 0}, .02 * kH)),
      testing::half_space(at, {0, 0, -1}, -.5));
  const PiecewiseDomain domain = intersection(cube.domain, complement(groove));
  const PiecewiseMesh made = make_piecewise_mesh(domain, background_of(cube, kH));
  ASSERT_EQ(made.status, UmStatus::Success);
  EXPECT_FALSE(made.defects.empty());
  const FeatureMeasures features = measure_features(domain, made);
  EXPECT_GT(features.n_missed_curves, 0U);
  EXPECT_GT(features.missed_length, 0);
  EXPECT_LT(features.missed_length, features.length);
  CertificateInput input;
  input.mesh = &made.mesh;
  const MeshCertificate certificate = certify(input);
  EXPECT_EQ(certificate.quality.n_inverted, 0U);
  EXPECT_TRUE(certificate.boundary.closed_manifold);
}

TEST(PiecewiseMesh, ADomainThatLeavesTheBackgroundIsAStatus) {
  const PiecewiseBody body = piecewise_body("cube", {});
  const BackgroundMesh small(a15(), Box(Vec3::Constant(-.8), Vec3::Constant(.8)), kH);
  EXPECT_EQ(make_piecewise_mesh(body.domain, small).status, UmStatus::DomainLeavesBackground);
}

}  // namespace
}  // namespace umtet
