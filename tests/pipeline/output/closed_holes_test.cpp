// The built program, from outside: holes of a scan in certificate, report and exported files.

#include <cmath>
#include <numbers>

#include "mesh/io/tet_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/support/data_files.h"
#include "tests/support/shell.h"

namespace umtet {
namespace {

using std::numbers::pi;

class Holes : public Program {
 protected:
  /// 4000 even points of the unit sphere, but for those that are left out; a label each where they have some.
  void write_ball(const std::string& name, const std::function<bool(double x, double y, double z)>& left_out,
                  const std::function<int(double z)>& label = {}) const {
    std::ofstream out(folder / name);
    out.precision(17);
    for (int i = 0; i < 4000; ++i) {
      const double z = 1 - (2 * i + 1) / 4000., r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
      const double x = r * std::cos(a), y = r * std::sin(a);
      if (left_out(x, y, z)) continue;
      out << x << ' ' << y << ' ' << z << ' ' << x << ' ' << y << ' ' << z;
      if (label) out << ' ' << label(z);
      out << '\n';
    }
  }
  void write_ball_with_a_hole(const std::string& name) const {
    write_ball(name, [](double x, double, double) { return x > std::cos(kAngle); });
  }
  Json certificate(const std::string& name) const { return Json::parse(content(folder / name / "certificate.json")); }
  /// Names and numbers of the patches that the report of a case shows, and their areas.
  std::map<std::string, std::pair<int, double>> patches(const std::string& name) const {
    const std::string page = content(folder / name / "report.html"), mark = "id=\"scene\">";
    const std::size_t at = page.find(mark) + mark.size();
    const Json scene = Json::parse(page.substr(at, page.find("</script>", at) - at));
    std::map<std::string, std::pair<int, double>> found;
    for (const Json& p : scene["patches"]) {
      found[p["name"]] = {p["number"], p["area"]};
    }
    return found;
  }

  static constexpr double kAngle = .6;     ///< between the axis of the hole and its rim
  static constexpr double kArea = 1.0975;  // 2 pi (1 - cos kAngle)
};

TEST_F(Holes, AHoleIsNamed) {
  write_ball_with_a_hole("ball.xyz");
  const Result r = run("run ball.xyz -o ball --tets 20000 --units mm --export inp,msh22 -v");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("\nholes     1 closed where there are no samples: "), std::string::npos) << r.out;
  const Json domain = certificate("ball")["domain"];
  EXPECT_EQ(domain["n_closed_holes"], 1);
  ASSERT_EQ(domain["closed_holes"].size(), 1u);
  const Json hole = domain["closed_holes"][0];
  EXPECT_NEAR(hole["rim"]["length"].get<double>(), 2 * pi * std::sin(kAngle), .05 * 2 * pi * std::sin(kAngle));
  EXPECT_NEAR(hole["rim"]["diameter"].get<double>(), 2 * std::sin(kAngle), .05);
  EXPECT_EQ(hole["rim"]["n"], 1);
  EXPECT_NEAR(hole["area"].get<double>(), kArea, .07 * kArea);
  EXPECT_NEAR(hole["deepest"].get<double>(), 2 * std::sin(kAngle / 2), .08);
  EXPECT_GT(hole["centre"][0], .8);
  EXPECT_GT(domain["support_radius"], .1);
  const std::string page = content(folder / "ball/report.html");
  EXPECT_NE(page.find("data-hole=\"0\""), std::string::npos);
  EXPECT_EQ(page.find("data-hole=\"1\""), std::string::npos);
  const auto shown = patches("ball");
  ASSERT_EQ(shown.size(), 2u);
  EXPECT_EQ(shown.at("boundary_1").first, 2) << "the number of the boundary without a hole";
  EXPECT_EQ(shown.at("closed_holes").first, 3);
  EXPECT_NEAR(shown.at("closed_holes").second, hole["area"].get<double>(), .03 * kArea);
  const std::string inp = content(folder / "ball/4-export/mesh.inp"),
                    msh = content(folder / "ball/4-export/mesh_22.msh");
  EXPECT_NE(inp.find("*NSET, NSET=closed_holes"), std::string::npos);
  EXPECT_NE(inp.find("NAME=closed_holes"), std::string::npos);
  EXPECT_NE(msh.find("3 \"closed_holes\""), std::string::npos) << msh.substr(0, 200);
  // A mesh of the same body has the same hole.
  const Result check = run("check ball/3-mesh/mesh.vtu --against ball --json");
  const Json checked = Json::parse(check.out)["check"]["domain"];
  EXPECT_EQ(checked["closed_holes"], domain["closed_holes"]);
  EXPECT_TRUE(Json::parse(run("check ball/3-mesh/mesh.vtu --json").out)["check"]["domain"]["closed_holes"].is_null());
  // The script for ParaView shows it.
  ASSERT_EQ(run("view ball").code, 0);
  EXPECT_EQ(content(folder / "ball/5-view/view.py").find("support_radius = None"), std::string::npos);
}

TEST_F(Holes, AWholeBodyHasNone) {
  write_ball("ball.xyz", [](double, double, double) { return false; });
  const Result r = run("run ball.xyz -o ball --tets 20000 --export inp");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.out.find("\nholes"), std::string::npos) << r.out;
  const Json domain = certificate("ball")["domain"];
  EXPECT_EQ(domain["n_closed_holes"], 0);
  EXPECT_TRUE(domain["closed_holes"].empty());
  EXPECT_EQ(patches("ball").count("boundary"), 1u);
  EXPECT_EQ(patches("ball").size(), 1u);
  const std::string page = content(folder / "ball/report.html");
  EXPECT_EQ(page.find("id=\"holes\""), std::string::npos);
  ASSERT_EQ(run("view ball").code, 0);
  EXPECT_NE(content(folder / "ball/5-view/view.py").find("support_radius = None"), std::string::npos);
}

TEST_F(Holes, TheDuckHasNone) {
  ASSERT_EQ(run("run '" + test::committed_cloud("duck.ply").string() + "' -o duck --h .08").code, 0);
  EXPECT_EQ(certificate("duck")["domain"]["n_closed_holes"], 0);
}

TEST_F(Holes, TwoAreTwo) {
  write_ball("ball.xyz", [](double x, double y, double) { return x > std::cos(.5) || y < -std::cos(kAngle); });
  ASSERT_EQ(run("run ball.xyz -o ball --tets 20000").code, 0);
  const Json holes = certificate("ball")["domain"]["closed_holes"];
  ASSERT_EQ(holes.size(), 2u);
  EXPECT_LT(holes[0]["centre"][1], -.8) << "the larger one is the first";
  EXPECT_GT(holes[1]["centre"][0], .8);
  write_ball_with_a_hole("one.xyz");
  ASSERT_EQ(run("run one.xyz -o one --tets 20000 --no-report").code, 0);
  const Json stages = Json::parse(run("diff ball one --json").out)["diff"]["stages"];
  EXPECT_EQ(stages[2]["difference"]["closed_holes_a"], 2);
  EXPECT_EQ(stages[2]["difference"]["closed_holes_b"], 1);
}

TEST_F(Holes, AFormulaHasNoSamplesToMiss) {
  ASSERT_EQ(run(ball).code, 0);
  const Json domain = certificate("ball")["domain"];
  for (const char* key : {"unsupported_area_fraction", "support_radius", "n_closed_holes", "closed_holes"}) {
    EXPECT_TRUE(domain[key].is_null()) << key;
  }
}

TEST_F(Holes, ThePatchTakesItsFacesFromTheOthers) {
  const auto hole = [](double x, double, double) { return x > std::cos(kAngle); };
  write_ball("ball.xyz", hole, [](double z) { return z > 0 ? 1 : 2; });
  ASSERT_EQ(run("run ball.xyz -o ball --tets 20000 --label-names 1=top,2=bottom").code, 0);
  const auto labelled = patches("ball");
  ASSERT_EQ(labelled.size(), 3u);
  EXPECT_EQ(labelled.at("top").first, 1);
  EXPECT_EQ(labelled.at("bottom").first, 2);
  EXPECT_EQ(labelled.at("closed_holes").first, 4) << "the body has 3";
  EXPECT_NEAR(labelled.at("top").second, (4 * pi - kArea) / 2, .3);
  EXPECT_NEAR(labelled.at("closed_holes").second, kArea, .1 * kArea);
  const Result taken = run("export ball --format inp --label-names 1=Closed_Holes");
  EXPECT_EQ(taken.code, 2);
  EXPECT_NE(taken.err.find("no sample supports"), std::string::npos) << taken.err;
}

TEST_F(Holes, CurvedTetsHaveThePatchToo) {
  write_ball_with_a_hole("ball.xyz");
  ASSERT_EQ(run("run ball.xyz -o ball --tets 8000 --order 2 --export msh22,inp").code, 0);
  const std::string msh = content(folder / "ball/4-export/mesh_22.msh");
  EXPECT_NE(msh.find("3 \"closed_holes\""), std::string::npos) << msh.substr(0, 200);
}

TEST_F(Holes, EveryFileHasThePatch) {
  if (!test::succeeds(std::string(test::kPython) + " -c 'import meshio, h5py'")) GTEST_SKIP() << "no meshio";
  write_ball_with_a_hole("ball.xyz");
  ASSERT_EQ(run("run ball.xyz -o ball --tets 8000 --export vtu,msh,msh22,mesh,inp,bdf,xdmf,stl").code, 0);
  const fs::path out = folder / "ball/4-export";
  EXPECT_TRUE(fs::exists(out / "mesh.closed_holes.stl"));
  std::string command = std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_back.py";
  const std::vector<const char*> files = {"mesh.msh", "mesh_22.msh",       "mesh.mesh",
                                          "mesh.bdf", "mesh_boundary.vtu", "mesh_boundary.xdmf",
                                          "mesh.inp", "mesh.vtu",          "mesh.xdmf"};
  for (const char* file : files) command.append(" ").append((out / file).string());
  std::istringstream lines(test::shell(command));
  std::string line;
  for (const char* file : files) {
    std::getline(lines, line);
    const Json found = Json::parse(line);
    if (found["faces"] > 0) {
      EXPECT_NEAR(found["area"].value("3", 0.), kArea, .1 * kArea) << file;
    } else {
      EXPECT_GT(found["node_sets"].value("closed_holes", 0), 50) << file;
    }
  }
}

}  // namespace
}  // namespace umtet
