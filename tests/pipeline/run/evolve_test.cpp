// umtet evolve, from outside, and the times it is asked for.

#include <algorithm>
#include <map>
#include <set>

#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/output/step_plot.h"
#include "pipeline/run/time_steps.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

const std::string kBall =
    "evolve --implicit '(x-t)^2+y^2+z^2-1' --box=-1.6,-1.6,-1.6,2.2,1.6,1.6 --h .25 -o moving --progress none ";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++n;
  return n;
}

TEST(TimeSteps, AreTheDecimalNumbersThatWereMeant) {
  const std::vector<TimeStep> steps = time_steps("0:0.1:4.5", "3.1,3.4", {});
  ASSERT_EQ(steps.size(), 44u);
  EXPECT_EQ(steps[3].t, .3);  // 3 * .1 is more
  EXPECT_EQ(steps[31].t, 3.2);
  EXPECT_EQ(steps.back().t, 4.5);
  EXPECT_EQ(time_steps("-1:0.4:0.9", "", {}).back().t, .6);
  EXPECT_EQ(time_steps("2:1:2", "", {}).size(), 1u);
}

TEST(TimeSteps, WhatIsNoRangeIsRefused) {
  for (const char* times :
       {"", "1", "0:1", "0:0:1", "0:-1:1", "1:1:0", "0:1:x", "0:1e-9:1", "1:1e-15:1.00000001", "nan:1:2"}) {
    EXPECT_THROW(time_steps(times, "", {}), UsageError) << times;
  }
  EXPECT_THROW(time_steps("0:1:3", "1.5", {}), UsageError);
  EXPECT_THROW(time_steps("0:1:1", "0,1", {}), UsageError);
}

TEST(StepPlot, MarksWhatCouldNotBeMade) {
  const std::string svg = step_plot({{0, true, .8, .9}, {1, false, 0, 0}, {2, true, .7, .8}});
  EXPECT_EQ(count(svg, "class=\"curve failed\""), 1u);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

TEST_F(Program, EveryInstantIsASubsetOfOneBackground) {
  const Result r = run(kBall + "--t 0:0.3:0.6 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json document = Json::parse(r.out);
  ASSERT_EQ(document["steps"].size(), 3u);
  std::map<std::int64_t, std::set<std::int64_t>> corners;  // of the tets of the background
  std::size_t n_tets = 0;
  for (int k = 0; k < 3; ++k) {
    const Json& step = document["steps"][k];
    EXPECT_EQ(step["verdict"], "pass");
    EXPECT_EQ(step["boundary"]["components"], 1);
    const MeshFile file = read_tet_mesh(folder / "moving" / step["file"].get<std::string>());
    double x = 0;
    for (const Vec3& v : file.mesh.V) x += v.x() / static_cast<double>(file.mesh.V.size());
    EXPECT_NEAR(x, .3 * k, .05);
    const auto& tets = std::get<std::vector<std::int64_t>>(file.cell_data.at("background_tet"));
    const auto& vertices = std::get<std::vector<std::int64_t>>(file.point_data.at("background_vertex"));
    n_tets += tets.size();
    for (std::size_t t = 0; t < tets.size(); ++t) {
      std::set<std::int64_t> ids;
      for (const int i : file.mesh.C[t]) ids.insert(vertices[i]);
      EXPECT_EQ(corners.emplace(tets[t], ids).first->second, ids);
    }
  }
  EXPECT_LT(corners.size(), .75 * static_cast<double>(n_tets));  // they share tets
  EXPECT_EQ(count(content(folder / "moving/series.pvd"), "<DataSet timestep=\"0."), 2u);
  EXPECT_EQ(count(content(folder / "moving/quality.csv"), "\n"), 4u);
  // Again, with fewer steps: nothing of the former ones is left.
  ASSERT_EQ(run(kBall + "--t 0:0.3:0.3").code, 0);
  EXPECT_FALSE(fs::exists(folder / "moving/step_0002.vtu"));
}

TEST_F(Program, AnInstantDoesNotDependOnTheOthersNorOnThreads) {
  const std::string ball =
      "evolve --implicit '(x-t)^2+y^2+z^2-1' --box=-1.6,-1.6,-1.6,2.2,1.6,1.6 --h .25 --progress none ";
  ASSERT_EQ(run(ball + "--t 0:0.3:0.6 -o all --threads 2").code, 0);
  ASSERT_EQ(run(ball + "--t 0.6:1:0.6 -o one --threads 1").code, 0);
  EXPECT_EQ(content(folder / "all/step_0002.vtu"), content(folder / "one/step_0000.vtu"));
}

TEST_F(Program, AnInstantThatCannotBeMeshedIsNamedAndTheOthersAreThere) {
  const Result r = run(kBall + "--t 0:0.8:1.6 --json");  // the last leaves the box
  EXPECT_EQ(r.code, 6);
  const Json steps = Json::parse(r.out)["steps"];
  EXPECT_EQ(steps[1]["verdict"], "pass");
  EXPECT_TRUE(steps[2]["file"].is_null());
  EXPECT_NE(steps[2]["error"].get<std::string>().find("larger --box"), std::string::npos) << steps[2];
  EXPECT_TRUE(fs::exists(folder / "moving/step_0001.vtu"));
  EXPECT_FALSE(fs::exists(folder / "moving/step_0002.vtu"));
  EXPECT_NE(content(folder / "moving/quality.csv").find("step_0002,1.6,,,,,,,,none,"), std::string::npos);
}

TEST_F(Program, TheMeshDecidesWhereAnInstantIsThin) {
  // Eq. (13) of the paper: necks of 1.02 h, meshed right.
  const Result necks =
      run("evolve --implicit 'x^2+y^2+z^2+sin(t*x)+sin(t*y)+sin(t*z)-1' --box=-2.1,-2.1,-2.1,2.1,2.1,2.1 --h .0922 --t "
          "3.9:1:3.9 "
          "-o necks --json");
  EXPECT_EQ(necks.code, 0) << necks.out;
  const Json passed = Json::parse(necks.out)["steps"][0];
  EXPECT_EQ(passed["verdict"], "pass");
  EXPECT_GT(passed["resolution"]["too_thin"].size(), 0u);
  // A lens of .12 at h = .3 folds: its places stand beside what is wrong with the mesh.
  const std::string lens =
      "evolve --implicit 'x^2+y^2+(z/0.12)^2-1' --box=-1.6,-1.6,-.9,1.6,1.6,.9 --h .3 --t 0:1:0 -o lens --json ";
  const Result folded = run(lens);
  EXPECT_EQ(folded.code, 6);
  const Json step = Json::parse(folded.out)["steps"][0];
  EXPECT_TRUE(step["file"].is_string());
  EXPECT_EQ(step["verdict"], "fail") << step;
  EXPECT_EQ(step["resolution"]["too_thin"].size(), 1u) << step;
}

TEST_F(Program, AnInstantThatIsOnlyCoarseIsKeptAndNamed) {
  // Thin for h, too, which is not what is wrong with its few tets.
  const std::string body = "evolve --implicit 'x^2+y^2+4*z^2-1' --box=-6,-6,-6,6,6,6 --h 1.6 --t 2:1:2 -o coarse ";
  const Result r = run(body + "--json");
  EXPECT_EQ(r.code, 6);
  const Json step = Json::parse(r.out)["steps"][0];
  EXPECT_GT(step["resolution"]["too_thin"].size(), 0u) << step;
  EXPECT_EQ(step["verdict"], "fail") << step;
  ASSERT_EQ(step["reasons"].size(), 1u) << step;
  EXPECT_TRUE(step["reasons"][0].get<std::string>().starts_with("volume_gap")) << step;
  EXPECT_TRUE(fs::exists(folder / "coarse/step_0000.vtu"));
  EXPECT_NE(run(body).out.find("failed    t = 2: volume_gap"), std::string::npos);
}

TEST_F(Program, ACloudThatIsMissingOrBadIsNamedAndTheOthersAreThere) {
  write_cloud("second.ply", [](const double(&x)[6]) {
    return std::to_string(x[0]) + " " + std::to_string(x[1] + .2) + " " + std::to_string(x[2]) + " " +
           std::to_string(x[3]) + " " + std::to_string(x[4]) + " " + std::to_string(x[5]);
  });
  std::ofstream(folder / "bad.ply") << "no cloud\n";
  std::ofstream(folder / "list") << "# an egg\negg.ply\nmissing.ply\n\nbad.ply\nsecond.ply\n";
  const Result r = run("evolve --clouds list --h .2 -o moving --progress none --json");
  EXPECT_EQ(r.code, 6) << r.err;
  const Json steps = Json::parse(r.out)["steps"];
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[0]["verdict"], "pass");
  EXPECT_NE(steps[1]["error"].get<std::string>().find("missing.ply"), std::string::npos);
  EXPECT_NE(steps[2]["error"].get<std::string>().find("bad.ply"), std::string::npos);
  EXPECT_EQ(steps[3]["verdict"], "pass");
  EXPECT_EQ(steps[3]["t"], 3);
  EXPECT_LT(steps[3]["cloud"]["rms_distance_over_h"].get<double>(), .1);
  EXPECT_TRUE(fs::exists(folder / "moving/step_0003.vtu"));
}

TEST_F(Program, EvolutionsThatCannotBeginTouchNothing) {
  fs::create_directories(folder / "moving");
  std::ofstream(folder / "moving/notes") << "mine\n";
  EXPECT_EQ(run(kBall + "--t 0:0.3:0.6").code, 2);
  EXPECT_EQ(content(folder / "moving/notes"), "mine\n");
  EXPECT_EQ(run("evolve --implicit 'x^2+' --box=-1,-1,-1,1,1,1 --h .2 --t 0:1:2 -o other").code, 2);
  EXPECT_EQ(run("evolve --implicit 'x^2-t' --box=-1,-1,-1,1,1,1 --clouds list --t 0:1:2 -o other").code, 2);
  EXPECT_EQ(run(kBall + "--t 0:0.3:0.6 --smooth 3").code, 2);  // belongs to clouds
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-t' --box=-1,-1,-1,1,1,1 --h .2 -o other").code, 2);
}

TEST_F(Program, AStoppedEvolutionListsWhatItHasMade) {
  const Result r =
      run("evolve --implicit 'x^2+y^2+z^2-1-t' --box=-1.6,-1.6,-1.6,1.6,1.6,1.6 --h .08 -o moving "
          "--t 0:0.001:0.5 --progress none",
          // stopped when the second step is there
          "f() { \"$@\" & p=$!; while kill -0 $p && [ ! -e moving/step_0001.vtu ]; do sleep .02; done; "
          "kill -TERM $p; wait $p; }; f");
  EXPECT_EQ(r.code, 143);
  const std::string series = content(folder / "moving/series.pvd");
  const std::size_t n = count(series, "<DataSet");
  EXPECT_GT(n, 0u);
  EXPECT_LT(n, 400u);
  EXPECT_NE(series.find("</VTKFile>"), std::string::npos);
  char name[64];
  for (std::size_t k = 0; k < n; ++k) {
    std::snprintf(name, sizeof name, "moving/step_%04zu.vtu", k);
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  }
}

}  // namespace
}  // namespace umtet
