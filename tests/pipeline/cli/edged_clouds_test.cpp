// The program on clouds of parts: a function for every smooth patch, and every edge in the mesh.

#include "tests/support/edged_clouds.h"

#include <vector>

#include "tests/pipeline/cli/program_fixture.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {

constexpr std::size_t kSamples = 2500;

class EdgedClouds : public Program {
 protected:
  void write_cloud(const std::string& name, const std::vector<Vec3>& points, const std::vector<Vec3>& normals) const {
    std::ofstream out(folder / name);
    out.precision(12);
    for (std::size_t i = 0; i < points.size(); ++i) {
      out << points[i].transpose();
      if (!normals.empty()) out << ' ' << normals[i].transpose();
      out << '\n';
    }
  }
  Json certificate_of(const std::string& name) const {
    return Json::parse(content(folder / name / "certificate.json"));
  }
};

TEST_F(EdgedClouds, ACylinderWithNoiseHasItsCircles) {
  const testing::EdgedCloud cloud = testing::edged_cloud("cylinder", kSamples, .001, 5, 1);
  write_cloud("part.xyz", cloud.points, cloud.normals);
  const Result r = run("run part.xyz -o part --tets 20000");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = certificate_of("part");
  EXPECT_EQ(c["verdict"], "pass");
  EXPECT_EQ(c["fits_input"], true);
  EXPECT_EQ(c["n_points"], kSamples);
  EXPECT_EQ(c["features"]["curves"], cloud.truth.curves.size());
  EXPECT_EQ(c["features"]["patches"], cloud.patches.count);
  EXPECT_EQ(c["features"]["missed_curves"], 0);
  EXPECT_GE(c["quality"]["min"].get<double>(), .75);
  for (const char* file : {"features.vtp", "patches.vtp"}) EXPECT_TRUE(fs::exists(folder / "part/2-level-set" / file));
  // The mesh stage alone divides the cloud again, to the bit.
  const std::string before = content(folder / "part/3-mesh/mesh.vtu");
  ASSERT_EQ(run("mesh part --force").code, 0);
  EXPECT_EQ(content(folder / "part/3-mesh/mesh.vtu"), before);
  // Without edges.
  ASSERT_NE(run("run part --no-report --edges off").code, 2);
  EXPECT_TRUE(fs::exists(folder / "part/2-level-set/level_set.vti"));
  EXPECT_FALSE(certificate_of("part").contains("features"));
}

TEST_F(EdgedClouds, EstimatedNormalsKeepTheEdgesOfACube) {
  const testing::EdgedCloud cloud = testing::edged_cloud("cube", kSamples, .0005, 0, 2);
  write_cloud("cube.xyz", cloud.points, {});
  const Result r = run("run cube.xyz -o cube --no-report --tets 20000");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = certificate_of("cube");
  EXPECT_EQ(c["features"]["curves"], 12);
  EXPECT_EQ(c["features"]["corners"], 8);
  EXPECT_EQ(c["features"]["missed_curves"], 0);
}

TEST_F(EdgedClouds, ASmoothCloudHasNone) {
  const OrientedPointCloud torus = test::torus_cloud(static_cast<int>(kSamples));
  write_cloud("torus.xyz", torus.points, torus.normals);
  const Result r = run("run torus.xyz -o torus --no-report --tets 20000");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(fs::exists(folder / "torus/2-level-set/level_set.vti"));
  EXPECT_FALSE(certificate_of("torus").contains("features"));
}

}  // namespace
}  // namespace umtet
