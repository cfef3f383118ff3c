// The program on triangles with sharp edges: a function for every smooth patch, and every edge in the mesh.

#include "reconstruct/triangles/triangle_mesh.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

class EdgedTriangles : public Program {
 protected:
  /// Triangles in order of their labels; each label is a solid.
  void write_stl(const std::string& name, const TriangleMesh& mesh) const {
    std::ofstream out(folder / name);
    out.precision(17);
    out << "solid part\n";
    for (std::size_t f = 0; f < mesh.F.size(); ++f) {
      if (f > 0 && !mesh.labels.empty() && mesh.labels[f] != mesh.labels[f - 1])
        out << "endsolid\nsolid inlet_" << mesh.labels[f] << '\n';
      out << "facet normal 0 0 0\nouter loop\n";
      for (int k = 0; k < 3; ++k) out << "vertex " << mesh.corner(f, k).transpose() << '\n';
      out << "endloop\nendfacet\n";
    }
    out << "endsolid\n";
  }
  Json certificate_of(const std::string& name) const {
    return Json::parse(content(folder / name / "certificate.json"));
  }
};

/// Corners off the lattice's planes.
TriangleMesh tilted_cube() {
  TriangleMesh mesh = test::cube();
  const Mat3 R = Eigen::AngleAxisd(.6, Vec3(3, 1, 2).normalized()).toRotationMatrix();
  for (Vec3& x : mesh.V) x = R * x + Vec3(10, 20, 30);
  return mesh;
}

TEST_F(EdgedTriangles, ACubeIsACube) {
  write_stl("cube.stl", tilted_cube());
  const Result r = run("run cube.stl -o cube --strict");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = certificate_of("cube");
  EXPECT_EQ(c["verdict"], "pass");
  EXPECT_EQ(c["features"]["curves"], 12);
  EXPECT_EQ(c["features"]["corners"], 8);
  EXPECT_EQ(c["features"]["patches"], 6);
  EXPECT_EQ(c["features"]["missed_curves"], 0);
  EXPECT_NEAR(c["volume"].get<double>(), 1, 1e-9);
  EXPECT_LT(c["triangles"]["max_distance"].get<double>(), 1e-9);
  EXPECT_LT(c["triangles"]["max_distance_back"].get<double>(), 1e-9);
  EXPECT_GE(c["quality"]["min"].get<double>(), .75);
  EXPECT_LE(c["n_tets"].get<int>(), 60000);
  EXPECT_TRUE(fs::exists(folder / "cube/2-level-set/features.vtp"));
  EXPECT_FALSE(fs::exists(folder / "cube/2-level-set/level_set.vti"));
  // A finished case is left alone, and the mesh stage repeats alone to the bit.
  EXPECT_NE(run("run cube").err.find("up to date"), std::string::npos);
  const std::string before = content(folder / "cube/3-mesh/mesh.vtu");
  ASSERT_EQ(run("mesh cube --force").code, 0);
  EXPECT_EQ(content(folder / "cube/3-mesh/mesh.vtu"), before);
  EXPECT_EQ(run("check cube/3-mesh/mesh.vtu --against cube --strict").code, 0);
}

TEST_F(EdgedTriangles, APlateThinnerThanItsEdgesIsExact) {
  TriangleMesh plate = test::cube();
  for (Vec3& x : plate.V) x = x.cwiseProduct(Vec3(12, 8, 1));
  write_stl("plate.stl", plate);
  const Result r = run("run plate.stl -o plate --no-report");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = certificate_of("plate");
  EXPECT_NEAR(c["volume"].get<double>(), 96, 1e-8);
  EXPECT_EQ(c["features"]["missed_curves"], 0);
  EXPECT_LE(c["n_tets"].get<int>(), 200000);
}

/// Its inner edges are nearer to the outer side than to boundary vertices of their own side.
TEST_F(EdgedTriangles, WallsAsThinAsAnEdgeKeepTheirInnerEdges) {
  write_stl("box.stl", test::open_box({20, 12, 8}, 1));
  const Result r = run("run box.stl -o box --no-report --h .8 --strict");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = certificate_of("box");
  EXPECT_EQ(c["verdict"], "pass");
  EXPECT_EQ(c["features"]["curves"], 24);
  EXPECT_EQ(c["features"]["missed_curves"], 0);
  EXPECT_NEAR(c["volume"].get<double>(), 20 * 12 * 8 - 18 * 10 * 7, 1e-7);
}

TEST_F(EdgedTriangles, EdgesOffAndCurvedTetsMakeOneSmoothLevelSet) {
  write_stl("cube.stl", tilted_cube());
  for (const char* how : {"--edges off", "--order 2"}) {
    SCOPED_TRACE(how);
    const Result r = run("run cube.stl -o smooth --fresh --no-report --h .12 " + std::string(how));
    EXPECT_NE(r.code, 2) << r.err;
    EXPECT_TRUE(fs::exists(folder / "smooth/2-level-set/level_set.vti"));
    EXPECT_FALSE(certificate_of("smooth").contains("features"));
  }
}

TEST_F(EdgedTriangles, SmoothTrianglesHaveNoFeatures) {
  write_stl("torus.stl", test::torus());
  const Result r = run("run torus.stl -o torus --no-report --h .12");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(fs::exists(folder / "torus/2-level-set/level_set.vti"));
  EXPECT_FALSE(certificate_of("torus").contains("features"));
}

/// A block with a groove of 8 degrees, in which there is no room for tets.
TriangleMesh grooved_block() { return test::prism({{.5, .3}, {.45, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {.55, 1}}, 1); }

TEST_F(EdgedTriangles, AMeshWithEdgesThatFailsIsMadeAgainWithoutThem) {
  write_stl("block.stl", grooved_block());
  const Result r = run("run block.stl -o block --no-report --h .12");
  EXPECT_NE(r.code, 2) << r.err;
  EXPECT_NE(r.err.find("one smooth level set"), std::string::npos) << r.err;
  EXPECT_TRUE(fs::exists(folder / "block/2-level-set/level_set.vti"));
  EXPECT_TRUE(certificate_of("block")["boundary"]["closed_manifold"].get<bool>());
  // Who asks for edges gets them, and what is wrong with them.
  const Result asked = run("run block.stl -o asked --no-report --h .12 --edges auto");
  EXPECT_EQ(asked.code, 6) << asked.out;
  EXPECT_TRUE(certificate_of("asked").contains("features"));
}

TEST_F(EdgedTriangles, BordersOfSolidsAreEdgesAndNameThePatches) {
  write_stl("cube.stl", test::cube_with_imprint());
  const Result seen = run("inspect cube.stl");
  EXPECT_NE(seen.out.find("16 sharp edges, 12 corners, 7 patches, 4 of the edges from the file's groups"),
            std::string::npos)
      << seen.out;
  const Result r = run("run cube.stl -o cube --no-report --h .1");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = certificate_of("cube");
  EXPECT_EQ(c["features"]["curves"], 16);
  EXPECT_EQ(c["features"]["missed_curves"], 0);
  EXPECT_NEAR(c["volume"].get<double>(), 1, 1e-9);
  const Result exported = run("export cube --format inp");
  ASSERT_EQ(exported.code, 0) << exported.err;
  const std::string text = content(folder / "cube/4-export/mesh.inp");
  EXPECT_NE(text.find("inlet_2"), std::string::npos);
  EXPECT_NE(text.find("part"), std::string::npos);
}

TEST_F(EdgedTriangles, GivenLinesReplaceTheEdgesUnlessBothAreAskedFor) {
  TriangleMesh mesh = test::cube_with_imprint();
  mesh.labels.clear();
  write_stl("cube.stl", mesh);
  std::ofstream(folder / "square.feat") << "feat 1\n5\n.3 .3 1\n.7 .3 1\n.7 .7 1\n.3 .7 1\n.3 .3 1\n";
  EXPECT_NE(run("inspect cube.stl --features square.feat").out.find("4 sharp edges, 4 corners, 2 patches"),
            std::string::npos);
  const std::string call = "run cube.stl -o cube --no-report --h .12 --features square.feat --edges auto";
  const Result both = run(call);
  ASSERT_EQ(both.code, 0) << both.out << both.err;
  EXPECT_NE(both.err.find("16 sharp edges, 12 corners, 7 patches, 4 of the edges from given lines"), std::string::npos)
      << both.err;
  EXPECT_EQ(certificate_of("cube")["features"]["missed_curves"], 0);
  // Another file makes another mesh.
  EXPECT_NE(run(call).err.find("up to date"), std::string::npos);
  std::ofstream(folder / "square.feat") << "feat 1\n3\n.3 .3 1\n.7 .3 1\n.7 .7 1\n";
  const Result again = run(call);
  EXPECT_NE(again.err.find("14 sharp edges"), std::string::npos) << again.err;
  // Lines elsewhere are refused before anything is made.
  std::ofstream(folder / "square.feat") << "feat 1\n2\n.3 .3 1\n.7 .3 1.5\n";
  const Result refused = run("run cube.stl -o other --features square.feat");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("square.feat: line 4: the point 0.7 0.3 1.5 is 0.5 from the triangles"), std::string::npos)
      << refused.err;
  EXPECT_EQ(run("run " + cloud.string() + " -o third --features square.feat").code, 3);
}

}  // namespace
}  // namespace umtet
