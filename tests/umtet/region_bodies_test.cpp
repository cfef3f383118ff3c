// One mesh of several bodies by the facade: the mesh and the certificate of the program.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "mesh/expression/expression.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/reports/region_json.h"
#include "tests/support/shell.h"
#include "umtet/umtet.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

RegionBody of_formula(const char* name, const char* formula) {
  return region_body(name, shared_function(Expression(formula)));
}

TEST(RegionBodies, HaveTheMeshAndTheCertificateOfTheProgram) {
  const fs::path out = fs::path(::testing::TempDir()) / ("umtet_region_bodies_" + std::to_string(::getpid()));
  const std::string said = test::shell("'" UMTET_PROGRAM
                                       "' regions shell='x^2+y^2+z^2-1' core='x^2+y^2+z^2-.3' --box=-2,-2,-2,2,2,2 "
                                       "--tets 60000 -q -o '" +
                                       out.string() + "'");
  ASSERT_TRUE(said.ends_with("exit 0\n")) << said;
  const RegionBodyMesh mesh =
      mesh_region_bodies({of_formula("shell", "x^2+y^2+z^2-1"), of_formula("core", "x^2+y^2+z^2-.3")},
                         {.tets = 60000, .box = Box(Vec3::Constant(-2), Vec3::Constant(2))});
  std::ifstream json(out / "regions.json");
  EXPECT_EQ(document_of_regions(mesh).dump(), Json::parse(json).dump());
  const MeshFile file = read_tet_mesh(out / "regions.vtu");
  EXPECT_EQ(file.mesh.C, mesh.mesh.mesh.C);
  ASSERT_EQ(file.mesh.V.size(), mesh.mesh.mesh.V.size());
  EXPECT_TRUE(std::equal(file.mesh.V.begin(), file.mesh.V.end(), mesh.mesh.mesh.V.begin()));
  fs::remove_all(out);
}

TEST(RegionBodies, AFitKeepsItsCoordinatesAndItsSamples) {
  OrientedPointCloud cloud;
  constexpr int kSamples = 2000;
  const Vec3 centre(1000, -500, 20);
  for (int i = 0; i < kSamples; ++i) {
    const double z = 1 - (2 * i + 1.) / kSamples, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    cloud.normals.emplace_back(r * std::cos(a), r * std::sin(a), z);
    cloud.points.push_back(centre + cloud.normals.back());
  }
  const RegionBody ball = region_body("ball", fit_body(cloud));
  EXPECT_EQ(ball.samples.size(), cloud.points.size());
  EXPECT_LT(ball.psi(centre, nullptr, nullptr), 0);
  Vec3 gradient;
  EXPECT_NEAR(ball.psi(centre + Vec3(1, 0, 0), &gradient, nullptr), 0, .01);
  EXPECT_GT(gradient.normalized().x(), .99);
  const RegionBodyMesh mesh = mesh_region_bodies({ball}, {.tets = 60000});
  EXPECT_TRUE(mesh.reasons.empty()) << mesh.reasons.front();
  ASSERT_EQ(mesh.missed.size(), 1U);
  EXPECT_EQ(mesh.missed[0].n_missed, 0U);
  EXPECT_NEAR(mesh.certificate.regions.at(1).certificate.volume, 4.18879, .1);
}

TEST(RegionBodies, AFunctionNeedsAHessian) {
  struct NoHessian {
    double value(const Vec3& x) const { return x.norm() - 1; }
    Vec3 gradient(const Vec3& x) const { return x.normalized(); }
  };
  EXPECT_THROW(region_body("ball", shared_function(NoHessian())), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
