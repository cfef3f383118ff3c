#include "body/edges/cloud_domain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "mesh/certify/certificate.h"
#include "mesh/core/tet_quality.h"
#include "mesh/features/feature_measures.h"
#include "mesh/features/piecewise_mesh.h"
#include "tests/support/edged_clouds.h"

namespace umtet {
namespace {

using testing::edged_cloud;
using testing::EdgedCloud;

Box box_around(const std::vector<Vec3>& points, double margin) {
  Box box;
  for (const Vec3& x : points) box.extend(x);
  return {box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin)};
}

/// psi has the sign of the truth at random points of the box and near the samples.
void expect_signs(const CloudDomain& made, const PiecewiseDomain& truth, const EdgedCloud& cloud, double clear) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-.5, .5);
  const auto vector = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  const Box box = box_around(cloud.exact, .3 * cloud.diagonal);
  int n_inside = 0, n_wrong = 0;
  for (int k = 0; k < 6000; ++k) {
    const Vec3 x = k % 2 == 0 ? Vec3(box.center() + vector().cwiseProduct(box.sizes()))
                              : Vec3(cloud.exact[random() % cloud.exact.size()] + 6 * cloud.patches.spacing * vector());
    Vec3 g;
    const double f = truth.evaluate(x, &g, nullptr) / g.norm();
    if (std::abs(f) < clear) continue;
    n_inside += f < 0 ? 1 : 0;
    n_wrong += (f < 0) != (made.domain.value(x) < 0) ? 1 : 0;
  }
  EXPECT_GT(n_inside, 300);
  EXPECT_EQ(n_wrong, 0);
}

void expect_mesh(const CloudDomain& made, const EdgedCloud& cloud) {
  const double h = 2.5 * cloud.patches.spacing;
  const BackgroundMesh background(a15(), box_around(cloud.exact, 4 * h), h);
  const PiecewiseMesh mesh = make_piecewise_mesh(made.domain, background, {}, {}, &made.graph);
  ASSERT_EQ(mesh.status, UmStatus::Success);
  for (const FeatureDefect& d : mesh.defects) ADD_FAILURE() << to_string(d.kind) << " at " << d.where.transpose();
  const FeatureMeasures m = measure_features(made.domain, mesh);
  EXPECT_EQ(m.n_missed_corners + m.n_missed_curves + m.n_faces_without_patch, 0u);
  EXPECT_GT(m.least_cosine, .9);
  CertificateInput input;
  input.mesh = &mesh.mesh;
  input.positive_faces = &mesh.faces;
  EXPECT_TRUE(certify(input).is_embedded());
  double least = 1;
  for (const Tet& t : mesh.mesh.C) least = std::min(least, mean_ratio(mesh.mesh, t));
  EXPECT_GE(least, .75);
}

TEST(CloudDomain, MeshesOfPartsHaveEveryEdge) {
  for (const char* name : {"cube", "L", "cube-ball", "cylinder", "lens"}) {
    for (const auto& [noise, tilt_deg] : {std::pair{0., 0.}, {.001, 5.}, {.0025, 10.}}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(noise));
      PiecewiseDomain truth = testing::edged_domain_of("cube", {});
      const EdgedCloud cloud = edged_cloud(name, 3000, noise, tilt_deg, 1, &truth);
      const auto made = cloud_domain(cloud.points, cloud.patches);
      ASSERT_TRUE(made);
      EXPECT_EQ(made->graph.curves.size(), cloud.truth.curves.size());
      EXPECT_EQ(made->graph.corners.size(), cloud.truth.corners.size());
      expect_signs(*made, truth, cloud, .3 * cloud.patches.spacing);
      expect_mesh(*made, cloud);
    }
  }
}

TEST(CloudDomain, SignsAreRightNearHolesAndRibsWithNoise) {
  for (const char* name : {"bracket", "prism", "half-torus", "wedge60"}) {
    SCOPED_TRACE(name);
    PiecewiseDomain truth = testing::edged_domain_of("cube", {});
    const EdgedCloud cloud = edged_cloud(name, 3000, .0025, 10, 3, &truth);
    const auto made = cloud_domain(cloud.points, cloud.patches);
    ASSERT_TRUE(made);
    expect_signs(*made, truth, cloud, .5 * cloud.patches.spacing);
  }
}

TEST(CloudDomain, BordersThatAreNotSharpJoinPatches) {
  EdgedCloud cloud = edged_cloud("cylinder", 1500, .001, 5, 1);
  cloud.patches.borders.pop_back();
  cloud.patches.borders.front().sharp = false;
  EXPECT_FALSE(cloud_domain(cloud.points, cloud.patches));
}

}  // namespace
}  // namespace umtet
