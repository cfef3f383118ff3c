// The built program, from outside: what a run makes, and that it is the same when made again.

#include "mesh/io/tet_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

TEST_F(Program, FormulaBecomesACertifiedMesh) {
  const Result r = run(ball + "--json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json document = Json::parse(r.out);
  EXPECT_EQ(document["exit_code"], 0);
  const Json& c = document["certificate"];
  EXPECT_EQ(c["verdict"], "pass");
  EXPECT_EQ(c["boundary"]["genus"], 0);
  EXPECT_EQ(c["quality"]["n_inverted"], 0);
  EXPECT_LE(c["boundary"]["max_vertex_distance_over_h"], 1e-8);
  EXPECT_NEAR(c["n_tets"].get<double>(), 3000, 600);  // the choice of h promises 10 % on finer meshes
  EXPECT_NEAR(c["resolution"]["kappa_h_max"].get<double>(), c["h"].get<double>(), 1e-6);  // curvature 1
  EXPECT_TRUE(c["cloud"].is_null());
  EXPECT_EQ(Json::parse(content(folder / "ball/certificate.json")), c);
  for (const char* f : {"omega_h.vtu", "projected.vtu", "mesh.vtu", "quality.csv", "record.json"}) {
    EXPECT_GT(fs::file_size(folder / "ball/3-mesh" / f), 0u) << f;
  }
  EXPECT_FALSE(fs::exists(folder / "ball/1-cloud"));
}

TEST_F(Program, WhatDoesNotMoveIsStoredOnce) {
  using Ids = std::vector<std::int64_t>;
  const std::string made = "mesh --implicit 'x^2+y^2+z^2-1' --box=-1.3,-1.3,-1.3,1.3,1.3,1.3 --h .1 -o ";
  ASSERT_EQ(run(made + "shells").code, 0);
  ASSERT_EQ(run(made + "series --keep-iterates").code, 0);
  EXPECT_EQ(content(folder / "shells/3-mesh/mesh.vtu"), content(folder / "series/3-mesh/mesh.vtu"));
  const auto read = [&](const char* file) { return read_tet_mesh(folder / file); };
  const MeshFile mesh = read("shells/3-mesh/mesh.vtu");
  for (const std::string state : {"omega_h.vtu", "projected.vtu"}) {
    const MeshFile shell = read(("shells/3-mesh/" + state).c_str()), whole = read(("series/3-mesh/" + state).c_str());
    EXPECT_EQ(whole.mesh.C, mesh.mesh.C);
    EXPECT_LT(shell.mesh.C.size(), .7 * static_cast<double>(mesh.mesh.C.size()));
    // The shell and the interior of mesh.vtu together are the whole.
    const auto& in_shell = std::get<Ids>(shell.point_data.at("background_vertex"));
    const auto& in_whole = std::get<Ids>(whole.point_data.at("background_vertex"));
    for (std::size_t v = 0, s = 0; v < in_whole.size(); ++v) {
      while (s < in_shell.size() && in_shell[s] < in_whole[v]) ++s;
      const bool moves = s < in_shell.size() && in_shell[s] == in_whole[v];
      EXPECT_EQ(whole.mesh.V[v], moves ? shell.mesh.V[s] : mesh.mesh.V[v]);
    }
  }
}

TEST_F(Program, CloudBecomesACertifiedMeshOnceAndThenThereIsNothingToDo) {
  const Result first = run("run egg.ply -o egg --tets 4000");
  ASSERT_EQ(first.code, 0) << first.err << first.out;
  const auto written = fs::last_write_time(folder / "egg/3-mesh/mesh.vtu");
  const Result second = run("run egg.ply -o egg --tets 4000");
  EXPECT_EQ(second.code, 0);
  EXPECT_NE(second.err.find("nothing to do"), std::string::npos) << second.err;
  EXPECT_EQ(second.out, first.out);
  EXPECT_EQ(fs::last_write_time(folder / "egg/3-mesh/mesh.vtu"), written);
  // The case alone, and case.toml as a configuration, mean the same.
  EXPECT_NE(run("run egg").err.find("nothing to do"), std::string::npos);
  EXPECT_NE(run("run --config egg/case.toml -o egg").err.find("nothing to do"), std::string::npos);
}

TEST_F(Program, ChangedEdgeLengthKeepsStageOne) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 4000").code, 0);
  const auto written = fs::last_write_time(folder / "egg/2-level-set/level_set.vti");
  const std::string mesh = content(folder / "egg/3-mesh/mesh.vtu");
  const Result r = run("mesh egg --h .2 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(Json::parse(r.out)["stages_run"], Json::array({"mesh"}));
  EXPECT_EQ(Json::parse(r.out)["certificate"]["h"], .2);
  EXPECT_EQ(fs::last_write_time(folder / "egg/2-level-set/level_set.vti"), written);
  EXPECT_NE(content(folder / "egg/3-mesh/mesh.vtu"), mesh);
  EXPECT_NE(content(folder / "egg/case.toml").find("h = 0.2  # --h"), std::string::npos);
  // reconstruct CASE fits the same cloud again.
  const Result again = run("reconstruct egg --smooth 10 --json");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["stages_run"], Json::array({"level-set"}));
  EXPECT_FALSE(fs::exists(folder / "egg/certificate.json"));  // of a mesh of the former level set
}

// Stages of one run hand clouds and level sets on in memory; those of later runs read the files.
TEST_F(Program, WhatIsReadBackGivesTheSameBytesAsWhatIsHandedOn) {
  int line = 0;  // far from the origin, with every twentieth normal of another length, and an outlier
  write_cloud("far.ply", [&](const double(&x)[6]) {
    const double length = ++line % 20 == 0 ? 1.3 : 1, out = line == 7 ? 3 : 1;
    std::ostringstream s;
    s.precision(17);
    s << 1e6 + out * x[0] << ' ' << out * x[1] << ' ' << out * x[2];
    for (int d = 3; d < 6; ++d) s << ' ' << length * x[d];
    return s.str();
  });
  const auto bytes = [&] {
    return content(folder / "far/2-level-set/level_set.vti") + content(folder / "far/3-mesh/mesh.vtu");
  };
  ASSERT_EQ(run("run far.ply -o far --h .2 -q").code, 0);
  const std::string handed_on = bytes();
  for (const char* stage : {"far/2-level-set", "far/3-mesh"}) {
    fs::remove_all(folder / stage);
    ASSERT_EQ(run("run far.ply -o far --h .2 -q").code, 0);
    EXPECT_EQ(bytes(), handed_on) << stage;
  }
}

TEST_F(Program, ThreadsDoNotChangeAByte) {
  ASSERT_EQ(run("run egg.ply -o one --tets 4000 --threads 1 --no-report").code, 0);
  ASSERT_EQ(run("run egg.ply -o two --tets 4000 --threads 2 --no-report").code, 0);
  int n = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "one")) {
    if (!entry.is_regular_file() || entry.path().filename() == ".lock") continue;
    const fs::path other = folder / "two" / fs::relative(entry.path(), folder / "one");
    if (entry.path().extension() == ".json") {
      EXPECT_EQ(without_run(entry.path()), without_run(other)) << other;
    } else {
      EXPECT_EQ(content(entry.path()), content(other)) << other;
    }
    ++n;
  }
  EXPECT_EQ(n, 11);
}

TEST_F(Program, TheNumberOfTetsIsMadeAlsoInALargeBoxAndReported) {
  const Result r = run("mesh --implicit 'x^2+y^2+z^2-1' --box -9,-9,-9,9,9,9 --tets 600 -o a --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json c = Json::parse(r.out)["certificate"];
  EXPECT_NEAR(c["n_tets"].get<double>(), 600, 100);
  EXPECT_EQ(c["n_tets_asked"], 600);
  EXPECT_NE(run("mesh a").out.find("(requested: 600)"), std::string::npos);
}

TEST_F(Program, AFewOutliersMakeABubbleThatIsLeftOut) {
  // Five points around (2, 0, 0) with normals away from it, half a lattice cell apart: the fit closes a bubble there.
  std::string ply = content(cloud);
  ply.replace(ply.find("vertex 600"), 10, "vertex 605");
  ply += "2.05 0 0 1 0 0\n1.95 0 0 -1 0 0\n2 .05 0 0 1 0\n2 -.05 0 0 -1 0\n2 0 .05 0 0 1\n";
  std::ofstream(folder / "spots.ply") << ply;
  const Result r = run("run spots.ply -o spots --tets 4000 --detail 3 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json domain = Json::parse(r.out)["certificate"]["domain"];
  EXPECT_EQ(domain["components_of_zero_set"], 2);
  EXPECT_EQ(domain["components_meshed"], 1);
  EXPECT_EQ(domain["euler_characteristic_of_kept_components"], 2);
  ASSERT_EQ(domain["components_dropped"].size(), 1u);
  EXPECT_NE(domain["components_dropped"][0].get<std::string>().find(" samples within "), std::string::npos);
  EXPECT_NE(r.err.find("left out a piece"), std::string::npos) << r.err;
}

TEST_F(Program, FarFromTheOriginTheMeshComesBackWhereTheCloudIs) {
  // The egg moved by multiples of 2^20: its coordinates stay exact to 2^-32.
  const auto moved = [](double dx, double dy) {
    return [=](const double(&x)[6]) {
      std::ostringstream s;
      s.precision(17);
      s << x[0] + dx << ' ' << x[1] + dy << ' ' << x[2] << ' ' << x[3] << ' ' << x[4] << ' ' << x[5];
      return s.str();
    };
  };
  write_cloud("far.ply", moved(1048576, -2097152));
  const Result near = run("run egg.ply -o near --tets 3000 --json"), far = run("run far.ply -o far --tets 3000 --json");
  ASSERT_EQ(far.code, 0) << far.err;
  const Json a = Json::parse(near.out)["certificate"], b = Json::parse(far.out)["certificate"];
  // Another place of the lattice relative to the cloud: the fit differs by its own error, which is below 1e-3.
  EXPECT_NEAR(a["volume"], b["volume"], 1e-3);
  const Result check = run("check far/3-mesh/mesh.vtu --against far --json");
  // The certificate is about the file: another reader of it finds the same numbers, to the last digit.
  EXPECT_EQ(check.code, 0);
  const Json c = Json::parse(check.out)["check"];
  EXPECT_GT(b["boundary"]["max_vertex_distance_over_h"], 1e-10) << "rounding is not seen";
  EXPECT_EQ(c["quality"], b["quality"]);
  for (const char* key : {"max_vertex_distance_over_h", "max_centroid_distance_over_h", "min_cos_normal", "area"}) {
    EXPECT_EQ(c["boundary"][key], b["boundary"][key]) << key;
  }
  // Where doubles are too coarse for the mesh there is none.
  write_cloud("farther.ply", moved(1e12, 0));
  const Result none = run("run farther.ply -o farther --tets 3000");
  EXPECT_EQ(none.code, 5) << none.out;
  EXPECT_NE(none.err.find("nearer to the origin"), std::string::npos) << none.err;
  EXPECT_FALSE(fs::exists(folder / "farther/certificate.json"));
  EXPECT_EQ(run("export far --format mesh").code, 0);
  std::istringstream mesh(content(folder / "far/4-export/mesh.mesh"));
  std::string line;
  while (std::getline(mesh, line) && line != "Vertices") {
  }
  double n, v;
  mesh >> n >> v;
  EXPECT_NEAR(v, 1048576, 1.1);
}

TEST_F(Program, EveryTilingIsABackground) {
  for (const std::string tiling : {"z", "slab", "cube"}) {
    const Result r = run("mesh --implicit 'x^2+y^2+z^2-1' --box=-1.2,-1.2,-1.2,1.2,1.2,1.2 --tets 8000 --background " +
                         tiling + " -o " + tiling);
    EXPECT_EQ(r.code, 0) << r.out << r.err;
    EXPECT_NE(r.out.find("verdict   pass"), std::string::npos) << r.out;
  }
}

TEST_F(Program, AnyTetMeshIsABackground) {
  const std::string ball = "mesh --implicit 'x^2+y^2+z^2-1' --box=-1.3,-1.3,-1.3,1.3,1.3,1.3 ";
  // omega_h of a larger ball serves the unit ball, and a box with walls does.
  EXPECT_EQ(
      run("mesh --implicit 'x^2+y^2+z^2-2' --box=-1.6,-1.6,-1.6,1.6,1.6,1.6 --h .15 --keep-iterates -o large").code, 0);
  for (const std::string background : {"--background large/3-mesh/omega_h.vtu", "--h .15 --box-walls"}) {
    const Result r = run(ball + background + " --mode paper -o unit");
    EXPECT_EQ(r.code, 0) << background << r.out << r.err;
    EXPECT_NE(r.out.find("verdict   pass"), std::string::npos) << r.out;
  }
  EXPECT_NE(run(ball + "--background large/3-mesh/omega_h.vtu --h .1 -o a").err.find("its own edge lengths"),
            std::string::npos);
  EXPECT_NE(run(ball + "--background z --box-walls -o a").err.find("--background a15"), std::string::npos);
}

}  // namespace
}  // namespace umtet
