// The built program, from outside: exit codes, what is on disk afterwards, what is on stdout.

#include <signal.h>
#include <sys/resource.h>

#include <chrono>
#include <thread>

#include "tests/pipeline/program_fixture.h"

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

TEST_F(Program, ThreadsDoNotChangeAByte) {
  ASSERT_EQ(run("run egg.ply -o one --tets 4000 --threads 1").code, 0);
  ASSERT_EQ(run("run egg.ply -o two --tets 4000 --threads 2").code, 0);
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

TEST_F(Program, DamageIsNoticedAndMended) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const fs::path file = folder / "egg/2-level-set/level_set.vti";
  const std::string good = content(file);
  std::string bad = good;
  bad[bad.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bad;
  const Result strict = run("run egg.ply -o egg --tets 3000 --strict");
  EXPECT_EQ(strict.code, 8);
  EXPECT_NE(strict.err.find("level_set.vti"), std::string::npos) << strict.err;
  const Result mended = run("mesh egg");
  EXPECT_EQ(mended.code, 0) << mended.err;
  EXPECT_NE(mended.err.find("level_set.vti does not match its checksum; making it again"), std::string::npos);
  EXPECT_EQ(content(file), good);
}

TEST_F(Program, RefusedCloudsTouchNothing) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const std::string certificate = content(folder / "egg/certificate.json"), toml = content(folder / "egg/case.toml");
  std::ofstream(folder / "cut.ply") << content(cloud).substr(0, 2000);
  const Result r = run("run cut.ply -o egg --tets 3000 --json");
  EXPECT_EQ(r.code, 3);
  const Json document = Json::parse(r.out);
  EXPECT_EQ(document["exit_code"], 3);
  EXPECT_NE(document["error"].get<std::string>().find("cut.ply"), std::string::npos);
  EXPECT_EQ(content(folder / "egg/certificate.json"), certificate);
  EXPECT_EQ(content(folder / "egg/case.toml"), toml);
  EXPECT_EQ(run("run cut.ply -o new").code, 3);
  EXPECT_FALSE(fs::exists(folder / "new"));
  const Result missing = run("run none.ply -o new");
  EXPECT_EQ(missing.code, 7);
  EXPECT_NE(missing.err.find("none.ply"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "new"));
}

TEST_F(Program, CloudsThatCannotBoundABodyTouchNothing) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  std::map<fs::path, std::string> before;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "egg")) {
    if (entry.is_regular_file() && entry.path().filename() != ".lock") before[entry.path()] = content(entry.path());
  }
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\n";
  const std::string normals = "property double nx\nproperty double ny\nproperty double nz\n", end = "end_header\n";
  std::ofstream same(folder / "same.ply"), bare(folder / "bare.ply");
  same << head << normals << end;
  bare << head << end;
  for (int i = 0; i < 12; ++i) {
    same << "1 2 3 0 0 1\n";
    bare << i % 3 << ' ' << i / 3 << ' ' << i << '\n';
  }
  same.close();
  bare.close();
  for (const char* name : {"same.ply", "bare.ply"}) {
    const Result r = run("run " + std::string(name) + " -o egg --tets 3000 --force");
    EXPECT_EQ(r.code, 3) << r.err;
    EXPECT_NE(r.err.find(name), std::string::npos) << r.err;
    for (const auto& [file, bytes] : before) EXPECT_EQ(content(file), bytes) << name << " changed " << file;
    EXPECT_EQ(run("run " + std::string(name) + " -o new").code, 3);
    EXPECT_FALSE(fs::exists(folder / "new"));
  }
  EXPECT_NE(run("run egg.ply -o egg --tets 3000").err.find("nothing to do"), std::string::npos);
}

TEST_F(Program, ARunThatFailsOnTheWayLosesNothing) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  ASSERT_EQ(run("export egg --format stl,mesh").code, 0);
  const auto before = files_of("egg");
  write_cloud("inward.ply", [](const double(&x)[6]) {
    std::ostringstream s;
    for (int k = 0; k < 6; ++k) s << (k < 3 ? x[k] : -x[k]) << ' ';
    return s.str();
  });
  EXPECT_EQ(run("run inward.ply -o egg --tets 3000 --normals given").code, 4);
  EXPECT_EQ(files_of("egg"), before);
  // A fit that succeeds is kept for the next try when no mesh can be made of it.
  EXPECT_EQ(run("run egg.ply -o egg --set reconstruct.smoothing=.02 --tets 1e11", "timeout 20").code, 9);
  EXPECT_EQ(files_of("egg"), before);
  EXPECT_NE(run("run egg.ply -o egg --tets 3000").err.find("nothing to do"), std::string::npos);
  const Result next = run("run egg.ply -o egg --set reconstruct.smoothing=.02 --tets 2000 --json");
  ASSERT_EQ(next.code, 0) << next.err;
  EXPECT_EQ(Json::parse(next.out)["stages_run"], Json::array({"mesh"}));
  EXPECT_NE(content(folder / "egg/case.toml").find("smoothing = 0.02"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "egg/.next"));
  // What had been exported was another mesh.
  EXPECT_NE(next.err.find("removed mesh.mesh, mesh.stl"), std::string::npos) << next.err;
  EXPECT_TRUE(fs::is_empty(folder / "egg/4-export"));
  EXPECT_EQ(run("run egg.ply -o egg --set reconstruct.smoothing=.02 --tets 2000 --strict").code, 0);
}

TEST_F(Program, CaseTomlSaysWhatTheStagesWereMadeWith) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000 --units mm").code, 0);
  const std::string toml = content(folder / "egg/case.toml");
  EXPECT_EQ(run("run egg --set cloud.file=foo").code, 7);
  EXPECT_EQ(run("run egg --until cloud --set mesh.implicit=x").code, 2);
  EXPECT_EQ(run("run egg.ply -o egg --until level-set --h .2").code, 2);
  EXPECT_EQ(content(folder / "egg/case.toml"), toml);
  std::ofstream(folder / "other.toml") << "[mesh]\nsamples = 7\n[output]\nunits = \"m\"\n";
  EXPECT_EQ(run("run egg --until level-set --config other.toml").code, 0);
  EXPECT_NE(content(folder / "egg/case.toml").find("samples = 20"), std::string::npos);
  EXPECT_NE(content(folder / "egg/case.toml").find("units = 'mm'"), std::string::npos);
  // The same points from another file are another origin, and no other result.
  fs::copy(cloud, folder / "twin.ply");
  EXPECT_NE(run("run egg --set cloud.file=twin.ply").err.find("nothing to do"), std::string::npos);
  EXPECT_NE(content(folder / "egg/case.toml").find("twin.ply"), std::string::npos);
}

TEST_F(Program, EditedRecordsAndCertificatesAreDamage) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const std::string certificate = content(folder / "egg/certificate.json");
  const auto edit = [&](const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = content(file);
    text.replace(text.find(from), from.size(), to);
    std::ofstream(file) << text;
  };
  edit(folder / "egg/3-mesh/record.json", "\"n_inverted\": 0", "\"n_inverted\": 1");
  EXPECT_EQ(run("run egg --strict").code, 8);
  const Result mended = run("run egg --json");
  EXPECT_EQ(mended.code, 0);
  EXPECT_EQ(Json::parse(mended.out)["certificate"]["quality"]["n_inverted"], 0);
  EXPECT_NE(mended.err.find("own checksum; making it again"), std::string::npos) << mended.err;
  edit(folder / "egg/certificate.json", "\"pass\"", "\"good\"");
  EXPECT_EQ(run("run egg --strict").code, 8);
  const Result again = run("run egg");
  EXPECT_EQ(again.code, 0);
  EXPECT_NE(again.err.find("certificate.json does not match"), std::string::npos) << again.err;
  EXPECT_EQ(Json::parse(content(folder / "egg/certificate.json"))["verdict"], "pass");
  EXPECT_EQ(run("run egg --strict --min-quality .99").code, 6);  // another gate is no damage
}

TEST_F(Program, WhatHasNoEndOrTakesTooMuchIsRefusedAtOnce) {
  const std::string at_once = "timeout 10";  // dozens of times what it takes
  EXPECT_EQ(run("run /dev/zero -o a", at_once).code, 3);
  EXPECT_EQ(run("run pipe -o a", "mkfifo pipe; " + at_once).code, 3);
  EXPECT_FALSE(fs::exists(folder / "a"));
  const Result many = run("mesh --implicit 'x^2+y^2+z^2-1' --box -1.3,-1.3,-1.3,1.3,1.3,1.3 --tets 1e11 -o a", at_once);
  EXPECT_EQ(many.code, 9) << many.err;
  EXPECT_NE(many.err.find(" GB of memory"), std::string::npos) << many.err;
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-1' --box -2,-2,-2,2,2,2 --h 1e-4 --max-tets 1e12 -o a", at_once).code, 9);
}

TEST_F(Program, TheNumberOfTetsIsMadeAlsoInALargeBoxAndReported) {
  const Result r = run("mesh --implicit 'x^2+y^2+z^2-1' --box -9,-9,-9,9,9,9 --tets 600 -o a --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json c = Json::parse(r.out)["certificate"];
  EXPECT_NEAR(c["n_tets"].get<double>(), 600, 100);
  EXPECT_EQ(c["n_tets_asked"], 600);
  EXPECT_NE(run("mesh a").out.find("(asked for 600)"), std::string::npos);
}

TEST_F(Program, FoldersThatAreNoCasesAreNotOverwritten) {
  fs::create_directories(folder / "mine/1-cloud");
  std::ofstream(folder / "mine/1-cloud/cloud.ply") << "precious";
  const Result r = run("run egg.ply -o mine");
  EXPECT_EQ(r.code, 2);
  EXPECT_NE(r.err.find("choose another folder"), std::string::npos) << r.err;
  EXPECT_EQ(content(folder / "mine/1-cloud/cloud.ply"), "precious");
  std::ofstream(folder / "file") << "x";
  const Result file = run("run egg.ply -o file/case");
  EXPECT_EQ(file.code, 7);
  EXPECT_EQ(file.err.find("filesystem error"), std::string::npos) << file.err;
  EXPECT_NE(file.err.find("a part of this path is a file"), std::string::npos) << file.err;
}

TEST_F(Program, HelpIsAboutTheCommand) {
  for (const char* command : {"run", "reconstruct", "mesh", "check", "export"}) {
    const Result r = run(std::string(command) + " --help");
    EXPECT_EQ(r.code, 0);
    EXPECT_EQ(r.out.rfind("umtet " + std::string(command), 0), 0u) << r.out;
  }
  EXPECT_NE(run("reconstruct --help").out.find("{area,paper} (default area)"), std::string::npos);
  for (const char* planned : {"evolve --help", "batch", "report x --help"}) {
    const Result r = run(planned);
    EXPECT_EQ(r.code, 2) << planned;
    EXPECT_NE(r.err.find("not available yet"), std::string::npos) << r.err;
  }
  EXPECT_EQ(run("rum --help").code, 2);
  EXPECT_EQ(Json::parse(run("--json mesh nowhere").out)["exit_code"], 2);
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

TEST_F(Program, OneReasonToFailIsExitSixWithARemedy) {
  // A lens much thinner at its rim than h.
  const Result r =
      run("mesh --implicit 'x^2+y^2+(z/0.15)^2-1' --box=-1.6,-1.6,-.9,1.6,1.6,.9 --h .2 --mode paper --allow-thin -o lens");
  EXPECT_EQ(r.code, 6) << r.err;
  EXPECT_NE(r.out.find("verdict   fail"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("try a smaller --h"), std::string::npos) << r.out;
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
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-2' --box=-1.6,-1.6,-1.6,1.6,1.6,1.6 --h .15 -o large").code, 0);
  for (const std::string background : {"--background large/3-mesh/omega_h.vtu", "--h .15 --box-walls"}) {
    const Result r = run(ball + background + " --mode paper -o unit");
    EXPECT_EQ(r.code, 0) << background << r.out << r.err;
    EXPECT_NE(r.out.find("verdict   pass"), std::string::npos) << r.out;
  }
  EXPECT_NE(run(ball + "--background large/3-mesh/omega_h.vtu --h .1 -o a").err.find("its own edge lengths"),
            std::string::npos);
  EXPECT_NE(run(ball + "--background z --box-walls -o a").err.find("--background a15"), std::string::npos);
}

TEST_F(Program, UsageErrorsNameThePlaceAndTheRemedy) {
  const std::pair<const char*, const char*> cases[] = {
      {"mesh --implicit 'x^2+foo(y)' --box -1,-1,-1,1,1,1 -o a", "column 5"},
      {"mesh --implicit 'x^2+y^2-1' -o a", "--box"},
      {"run egg.ply -o a --smoth 1", "did you mean --smooth?"},
      {"run egg.ply -o a --tet 1000", "did you mean --tets?"},
      {"run egg.ply -o a --set mesh.sampels=1", "did you mean mesh.samples?"},
      {"run egg.ply -o a --tets 10 --h 1", "exclude each other"},
      {"run egg.ply -o a --mode quick", "fast, paper only"},
      {"run egg.ply -o a --background bcc", "must be a15, z, slab, cube or"},
      {"run egg.ply -o a --from mehs", "did you mean mesh?"},
      {"run egg.ply", "-o CASE"},
      {"rum egg.ply -o a", "did you mean run?"},
      {"mesh nowhere", "not a case"},
      {"check a.vtu --set mesh.h=1", "does not run"},
      {"mesh --implicit 'x' --box -1e120,-1e120,-1e120,1e120,1e120,1e120 -o a", "too large"},
      {"", "--help"}};
  for (const auto& [arguments, message] : cases) {
    const Result r = run(arguments);
    EXPECT_EQ(r.code, 2) << arguments;
    EXPECT_NE(r.err.find(message), std::string::npos) << arguments << "\n" << r.err;
    EXPECT_EQ(r.out, "") << arguments;
  }
  EXPECT_FALSE(fs::exists(folder / "a"));
  EXPECT_EQ(run("--version").out.substr(0, 6), "umtet ");
  EXPECT_EQ(run("mesh --help").code, 0);
}

TEST_F(Program, GatesAndImpossibleMeshesHaveTheirCodes) {
  const Result gate = run(ball + "--min-quality .99");
  EXPECT_EQ(gate.code, 6);
  EXPECT_NE(gate.out.find("below the gate"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "ball/3-mesh/mesh.vtu"));
  const Result no_gate = run(ball);  // the mesh is the same one, judged anew
  EXPECT_EQ(no_gate.code, 0);
  EXPECT_NE(no_gate.err.find("nothing to do"), std::string::npos);
  const auto before = files_of("ball");
  const Result rim = run("mesh --implicit 'x' --box -1,-1,-1,1,1,1 --h .2 -o ball");
  EXPECT_EQ(rim.code, 5);
  EXPECT_NE(rim.err.find("leaves"), std::string::npos) << rim.err;
  for (const auto& [file, bytes] : before) EXPECT_EQ(content(file), bytes) << file;
  EXPECT_TRUE(fs::exists(folder / "ball/3-mesh/failed/omega_h.vtu"));
  EXPECT_NE(run(ball).err.find("nothing to do"), std::string::npos);
  EXPECT_EQ(run("mesh --implicit 'x^2+1' --box -1,-1,-1,1,1,1 --tets 1000 -o none").code, 5);
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-1' --box -2,-2,-2,2,2,2 --h .001 -o ball").code, 9);
}

TEST_F(Program, CheckJudgesAnyMesh) {
  ASSERT_EQ(run(ball).code, 0);
  ASSERT_EQ(run("export ball --format msh,msh22,mesh,vtu,stl").code, 0);
  EXPECT_GT(fs::file_size(folder / "ball/4-export/mesh.stl"), 0u);
  Json first;
  for (const char* f : {"mesh.msh", "mesh_22.msh", "mesh.mesh", "mesh.vtu"}) {
    const Result r = run("check --json --against ball ball/4-export/" + std::string(f));
    ASSERT_EQ(r.code, 0) << f << r.err;
    const Json c = Json::parse(r.out)["check"];
    if (first.is_null()) first = c;
    EXPECT_EQ(c["quality"]["min"], first["quality"]["min"]) << f;  // formats keep all digits
    EXPECT_EQ(c["boundary"]["euler_characteristic"], 2);
  }
  EXPECT_EQ(run("check ball/3-mesh/mesh.vtu --min-quality .99").code, 6);
  EXPECT_EQ(run("check ball/3-mesh/mesh.vtu --set output.min_quality=.99").code, 6);
  std::ofstream(folder / "gate.toml") << "[output]\nmin_quality = 0.99\n[mesh]\nsamples = 7\n";
  EXPECT_EQ(run("check ball/3-mesh/mesh.vtu --config gate.toml").code, 6);
  std::ofstream(folder / "flat.mesh") << "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
                                         "1 1 0 0\nTetrahedra\n1\n1 2 3 4 1\nEnd\n";
  EXPECT_EQ(run("check flat.mesh").code, 6);
  EXPECT_EQ(run("check egg.ply").code, 3);
  EXPECT_EQ(run("check none.vtu").code, 7);
}

TEST_F(Program, AFullDiskIsFileTroubleAndLeavesNoHalfFile) {
  // 40 blocks of 512 or 1024 bytes: the record would fit, the meshes do not.
  const Result r = run(ball, "ulimit -f 40;");
  EXPECT_EQ(r.code, 7) << r.err;
  EXPECT_NE(r.err.find(".vtu"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(folder / "ball/certificate.json"));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "ball")) {
    EXPECT_FALSE(entry.path().extension() == ".vtu") << entry.path();
  }
  EXPECT_EQ(run(ball).code, 0);
  // The rest of the call, which sends stdout to a file, is a comment.
  EXPECT_EQ(run(ball + " >/dev/full 2>&1; exit $?; #").code, 7);
}

TEST_F(Program, InterruptedRunsLeaveAResumableCase) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::chdir(folder.c_str());
      ::execl(UMTET_PROGRAM, "umtet", "mesh", "--implicit", "x^2+y^2+z^2-1", "--box", "-1.3,-1.3,-1.3,1.3,1.3,1.3",
              "--tets", "300000", "--mode", "paper", "-o", "large", "-q", nullptr);
      ::_exit(127);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    ::kill(child, signal);
    const auto asked = std::chrono::steady_clock::now();
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), code);
    // A sweep over 300k tets takes well below a second; the rest is for a loaded machine.
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(4));
    EXPECT_FALSE(fs::exists(folder / "large/3-mesh/record.json"));
  }
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-1' --box -1.3,-1.3,-1.3,1.3,1.3,1.3 --tets 3000 -o large").code, 0);
}

TEST_F(Program, TheCommonFlagsAreUnderstoodByEveryCommand) {
  ASSERT_EQ(run(ball + "-v --progress none --threads 1").code, 0);
  for (const std::string command : {"check ball/3-mesh/mesh.vtu", "export ball --format stl"}) {
    const Result loud = run(command + " -v --progress plain --threads 1 --json");
    EXPECT_EQ(loud.code, 0) << loud.err;
    EXPECT_TRUE(Json::accept(loud.out));
    EXPECT_NE(loud.err.find(" tets, "), std::string::npos) << "-v says nothing: " << loud.err;
    EXPECT_EQ(run(command + " -q --progress none").err, "");
    EXPECT_EQ(run(command + " -q -v").code, 2);
  }
}

TEST_F(Program, AnswersInJsonAlsoWhenItFails) {
  for (const char* arguments : {"run --json", "mesh nowhere --json", "run none.ply -o a --json", "frobnicate --json"}) {
    const Result r = run(arguments);
    const Json document = Json::parse(r.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << arguments << r.out;
    EXPECT_EQ(document["exit_code"], r.code);
    EXPECT_TRUE(document.contains("error"));
  }
}

}  // namespace
}  // namespace umtet
