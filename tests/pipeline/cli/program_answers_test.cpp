// The built program, from outside: exit codes, messages and help.

#include <cmath>
#include <numbers>
#include <regex>

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

TEST_F(Program, HelpIsAboutTheCommand) {
  for (const char* command :
       {"run", "reconstruct", "mesh", "evolve", "batch", "inspect", "check", "export", "report", "view", "diff"}) {
    const Result r = run(std::string(command) + " --help");
    EXPECT_EQ(r.code, 0);
    EXPECT_EQ(r.out.rfind("umtet " + std::string(command), 0), 0u) << r.out;
    // Its own examples, and no others.
    const std::string example = "  umtet " + std::string(command) + " ";
    EXPECT_NE(r.out.find("\n" + example), std::string::npos) << r.out;
    std::istringstream lines(r.out);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_TRUE(!line.starts_with("  umtet ") || line.starts_with(example)) << line;
    }
    EXPECT_NE(r.out.find("\nExit codes: "), std::string::npos) << r.out;
  }
  const std::string help = run("reconstruct --help").out;
  EXPECT_NE(std::regex_replace(help, std::regex("\\s+"), " ").find("{auto,smooth,flat,none} (default auto)"), std::string::npos);
  EXPECT_EQ(run("rum --help").code, 2);
  EXPECT_EQ(Json::parse(run("--json mesh nowhere").out)["exit_code"], 2);
}

TEST_F(Program, AnEmptyValueIsAValue) {
  ASSERT_EQ(run("run egg.ply -o egg --box=-2,-2,-2,2,2,2 --h .3").code, 0);
  const Result r = run("mesh egg --box= --h .3");  // the next word is no value of --box
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("mesh.box was \"-2,-2,-2,2,2,2\", is \"\""), std::string::npos) << r.err;
}

TEST_F(Program, UsageErrorsNameThePlaceAndTheRemedy) {
  const std::pair<const char*, const char*> cases[] = {
      {"mesh --implicit 'x^2+foo(y)' --box -1,-1,-1,1,1,1 -o a", "column 5"},
      {"mesh --implicit 'x^2+y^2-1' -o a", "--box"},
      {"run egg.ply -o a --smoth 1", "did you mean --smooth?"},
      {"run egg.ply -o a --tet 1000", "did you mean --tets?"},
      {"mesh egg --spacing 1", "--spacing; it is a flag of umtet run, umtet reconstruct, "},
      {"run egg.ply -o a --set mesh.sampels=1", "did you mean mesh.samples?"},
      {"run egg.ply -o a --tets 10 --h 1", "mutually exclusive"},
      {"run egg.ply -o a --mode quick", "fast, paper only"},
      {"run egg.ply -o a --background bcc", "must be a15, z, slab, cube, graded, auto or"},
      {"run egg.ply -o a --from mehs", "did you mean mesh?"},
      {"mesh --implicit 'x^2+y^2+z^2-1' --box -2,-2,-2,2,2,2", "-o CASE is missing: a formula has no file name"},
      {"run egg.ply -o a --columns x,y", "x, y and z must be among them"},
      {"run", "CLOUD is missing"},
      {"rum egg.ply -o a", "did you mean run?"},
      {"egg.ply -o a", "did you mean umtet run egg.ply?"},
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

TEST_F(Program, WhatHasNoEndOrTakesTooMuchIsRefusedAtOnce) {
  const std::string at_once = "timeout 10";  // dozens of times what it takes
  EXPECT_EQ(run("run /dev/zero -o a", at_once).code, 3);
  EXPECT_EQ(run("run pipe -o a", "mkfifo pipe; " + at_once).code, 3);
  // A list of 1.5 GB of zeros took 23 GB.
  std::ofstream(folder / "large").close();
  fs::resize_file(folder / "large", 100 << 20);
  const std::pair<const char*, int> texts[] = {{"batch large -o a", 2},
                                               {"evolve --clouds large --h .1 -o a", 2},
                                               {"run egg.ply -o a --config large", 2},
                                               {"run egg.ply -o a --orient-from large", 3}};
  for (const auto& [arguments, code] : texts) {
    const Result r = run(arguments, at_once);
    EXPECT_EQ(r.code, code) << arguments << "\n" << r.err;
    EXPECT_NE(r.err.find("large: too large"), std::string::npos) << arguments << "\n" << r.err;
  }
  std::ofstream(folder / "long") << std::string(1 << 20, 'x');
  EXPECT_NE(run("batch long -o a", at_once).err.find("a line is longer than any path"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "a"));
  const Result many = run("mesh --implicit 'x^2+y^2+z^2-1' --box -1.3,-1.3,-1.3,1.3,1.3,1.3 --tets 1e11 -o a", at_once);
  EXPECT_EQ(many.code, 9) << many.err;
  EXPECT_NE(many.err.find(" GB of memory"), std::string::npos) << many.err;
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-1' --box -2,-2,-2,2,2,2 --h 1e-4 --max-tets 1e12 -o a", at_once).code, 9);
}

TEST_F(Program, FlagsAreInGroupsAndWrapped) {
  const std::string help = run("run --help").out;
  std::size_t at = 0;
  for (const char* group : {"Input:", "Level set:", "Size:", "Output:", "Stages:", "Verdict:", "Paper:", "Program:"}) {
    const std::size_t next = help.find("\n" + std::string(group) + "\n", at);
    ASSERT_NE(next, std::string::npos) << group;
    at = next;
  }
  EXPECT_GT(help.find("  --normals "), help.find("\nInput:"));
  EXPECT_LT(help.find("  --normals "), help.find("\nLevel set:"));
  std::istringstream lines(help.substr(help.find("\nInput:"), help.find("\nExamples:") - help.find("\nInput:")));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
  // Every flag of the command is there.
  for (const char* flag : {"-o", "--json", "-q,", "--until", "--max-memory", "--mode", "--accept", "--tets", "--edges"})
    EXPECT_NE(help.find("\n  " + std::string(flag)), std::string::npos) << flag;
}

TEST_F(Program, TheSummaryHasThreeLinesAndIsQuietOnRequest) {
  const auto first_words = [](const std::string& text) {
    std::vector<std::string> words;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) words.push_back(line.substr(0, line.find(' ')));
    return words;
  };
  const Result r = run(ball);
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(first_words(r.out), (std::vector<std::string>{"verdict", "quality", "doubts", "files"})) << r.out;
  EXPECT_NE(r.out.find("doubts    none\n"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("one body without handles"), std::string::npos) << r.out;
  EXPECT_EQ(run(ball + "-q").out, "");
  EXPECT_EQ(run("report ball -q").out, "");
  const std::string all = run(ball + "-v").out;
  EXPECT_NE(all.find("\nboundary  closed manifold"), std::string::npos) << all;
  EXPECT_NE(all.find("quality.csv"), std::string::npos) << all;
  const Result failed = run("mesh --implicit 'x^2+y^2+z^2-1' --box=-6,-6,-6,6,6,6 --h 5 -o coarse");
  EXPECT_EQ(first_words(failed.out), (std::vector<std::string>{"verdict", "quality", "blame", "files"})) << failed.out;
}

TEST_F(Program, GatesAndImpossibleMeshesHaveTheirCodes) {
  const Result gate = run(ball + "--min-quality .99 -v");
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
  // No number anywhere: by a given h, and by the samples that an h is chosen from.
  for (const char* size : {"--h .2", "--tets 1000"}) {
    const Result r = run("mesh --implicit 'sqrt(-1-x^2-y^2)' --box -1,-1,-1,1,1,1 -o none " + std::string(size));
    EXPECT_EQ(r.code, 5);
    EXPECT_NE(r.err.find("not finite"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("at ("), std::string::npos) << r.err;
  }
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-1' --box -2,-2,-2,2,2,2 --h .001 -o ball").code, 9);
}

TEST_F(Program, ABodyMeshedFarTooCoarselyIsNoSuccess) {
  for (const char* call :
       {"mesh --implicit 'x^2+y^2+z^2-1' --box=-6,-6,-6,6,6,6 --h 5 -o ball", "run egg.ply --h 5 -o egg"}) {
    const Result r = run(std::string(call) + " -v");
    EXPECT_EQ(r.code, 6) << r.err;
    EXPECT_NE(r.out.find("volume_gap: between the flat faces and psi = 0 lies"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("try a smaller --h"), std::string::npos) << r.out;
  }
  EXPECT_TRUE(fs::exists(folder / "ball/3-mesh/mesh.vtu"));
  const Json c = Json::parse(content(folder / "ball/certificate.json"));
  EXPECT_GT(c["boundary"]["gap_over_volume"], c["gates"]["volume_gap"]);
}

TEST_F(Program, OneReasonToFailIsExitSixWithARemedy) {
  // A lens much thinner at its rim than h.
  const Result r =
      run("mesh --implicit 'x^2+y^2+(z/0.15)^2-1' --box=-1.6,-1.6,-.9,1.6,1.6,.9 --h .2 --mode paper -o lens");
  EXPECT_EQ(r.code, 6) << r.err;
  EXPECT_NE(r.out.find("verdict   fail"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("try --h "), std::string::npos) << r.out;
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
    EXPECT_TRUE(c["n_positive_faces"].is_null()) << "nobody knows which were meant";
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

TEST_F(Program, SecondOrderIsMadeCertifiedAndChecked) {
  const Result made = run("run egg.ply -o egg --tets 3000 --order 2 --threads 1 --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const Json c = Json::parse(made.out)["certificate"];
  EXPECT_EQ(c["order"], 2);
  const Json& second = c["second_order"];
  EXPECT_EQ(second["n_nonpositive_jacobians"], 0);
  EXPECT_EQ(second["n_mid_sides_off_surface"], 0);
  EXPECT_GT(second["min_scaled_jacobian"], .5);
  EXPECT_EQ(2 * second["n_boundary_mid_sides"].get<int>(), 3 * c["n_positive_faces"].get<int>());
  EXPECT_LT(second["rms_face_distance_over_h"].get<double>(),
            .1 * c["boundary"]["max_centroid_distance_over_h"].get<double>());
  const double volume = c["volume"], curved = second["volume"];
  EXPECT_GT(curved, volume);  // chords of a convex body are inside

  const Result checked = run("check --json --against egg egg/3-mesh/mesh.vtu");
  ASSERT_EQ(checked.code, 0) << checked.err;
  Json same = Json::parse(checked.out)["check"]["second_order"];
  for (const auto& [key, value] : same.items()) EXPECT_EQ(value, second[key]) << key;
  const std::string mesh = content(folder / "egg/3-mesh/mesh.vtu");
  ASSERT_EQ(run("run egg.ply -o egg2 --tets 3000 --order 2 --threads 3").code, 0);
  EXPECT_EQ(content(folder / "egg2/3-mesh/mesh.vtu"), mesh);

  const Result again = run("mesh egg --order 1 --json");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(Json::parse(again.out)["certificate"]["second_order"].is_null());
  EXPECT_EQ(Json::parse(again.out)["certificate"]["volume"], volume);

  std::ofstream(folder / "bad.mesh") << "MeshVersionFormatted 2\nDimension 3\nVertices\n10\n0 0 0 0\n2 0 0 0\n0 2 0 0\n"
                                        "0 0 2 0\n1.8 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n0 1 1 0\n"
                                        "TetrahedraP2\n1\n1 2 3 4 5 6 7 8 9 10 1\nEnd\n";
  const Result bad = run("check bad.mesh");
  EXPECT_EQ(bad.code, 6);
  EXPECT_NE(bad.out.find("1 tets of second order have a Jacobian"), std::string::npos) << bad.out;
  EXPECT_EQ(run("evolve --implicit 'x^2+y^2+z^2-1' --box=-2,-2,-2,2,2,2 --h .3 --t 0:1:1 -o e --set mesh.order=2").code,
            2);
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

/// Two balls of radius .4 at x = -.8 and .8, and a rod of radius .02 between them: points with normals.
void write_dumbbell(const fs::path& file) {
  constexpr int kOnBall = 20000, kAround = 20;
  constexpr double kRadius = .4, kRod = .02, kAt = .8, kStep = .006, pi = std::numbers::pi;
  std::ofstream out(file);
  for (const double side : {-1., 1.}) {
    for (int i = 0; i < kOnBall; ++i) {  // on a spiral
      const double z = 1 - (2 * i + 1.) / kOnBall, r = std::sqrt(1 - z * z), t = pi * (1 + std::sqrt(5.)) * i;
      const double x = r * std::cos(t), y = r * std::sin(t);
      if (x * side < 0 && std::hypot(y, z) * kRadius < kRod) continue;
      out << side * kAt + kRadius * x << ' ' << kRadius * y << ' ' << kRadius * z << ' ' << x << ' ' << y << ' ' << z
          << '\n';
    }
  }
  const double end = kAt - std::sqrt(kRadius * kRadius - kRod * kRod);
  int ring = 0;
  for (double x = -end; x < end; x += kStep, ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const double t = 2 * pi * (i + .5 * (ring % 2)) / kAround, y = std::cos(t), z = std::sin(t);
      out << x << ' ' << kRod * y << ' ' << kRod * z << " 0 " << y << ' ' << z << '\n';
    }
  }
}

TEST_F(Program, AThinPartIsGradedWhereThatTakesLessThanHalfTheTets) {
  write_dumbbell(folder / "dumbbell.xyz");
  const Result r = run("run dumbbell.xyz -o dumbbell --no-report --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("mesh: graded, with edges of at least"), std::string::npos) << r.err;
  const Json certificate = Json::parse(std::ifstream(folder / "dumbbell/certificate.json"));
  EXPECT_EQ(certificate["boundary"]["genus"], 0);
  EXPECT_EQ(certificate["boundary"]["components"], 1);
  EXPECT_LT(certificate["n_tets"], 200000);  // with one h: 800,000
  EXPECT_GT(certificate["quality"]["min"], .7);
  // Whoever asks for one h, or for a mesh of another kind, gets it; so does a body without thin parts.
  const Result tets = run("mesh dumbbell --background a15 --tets 20000 --no-report");
  EXPECT_EQ(tets.err.find("graded"), std::string::npos) << tets.err;
  const Result egg = run("run egg.ply -o egg --no-report");
  EXPECT_EQ(egg.code, 0) << egg.err;
  EXPECT_EQ(egg.err.find("graded"), std::string::npos) << egg.err;
}

}  // namespace
}  // namespace umtet
