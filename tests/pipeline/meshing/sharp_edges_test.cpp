// umtet mesh --implicit with max, min and abs, from outside: bodies with sharp edges.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

constexpr double kPi = std::numbers::pi;
const std::string kBox = " --box=-1.9,-1.9,-1.9,1.9,1.9,1.9 ";

struct Body {
  const char* formula;
  int curves, corners, patches;
  double volume, tolerance;  ///< relative
  double least_quality;
};

// Points of a grid in the wedge of this prism are separate pieces of psi < 0.
TEST_F(Program, AGridThatCannotResolveAWedgeSaysNothingAgainstItsMesh) {
  const std::string x = "(.748867*(x+.098)-.618961*(y+.025)+.236825*(z+.045))",
                    y = "(.51323*(x+.098)+.767733*(y+.025)+.383643*(z+.045))",
                    z = "(-.419278*(x+.098)-.165752*(y+.025)+.892599*(z+.045))";
  const Result r = run("mesh --implicit 'max(max(.9659258*abs(" + y + ")-.2588190*(" + x + "+.9)," + x + "-.9),abs(" +
                       z + ")-1)' --box=-2.3,-2.3,-2.3,2.3,2.3,2.3 --h 0.2222 -o wedge");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const Json c = Json::parse(content(folder / "wedge/certificate.json"));
  EXPECT_EQ(c["verdict"], "pass");
  EXPECT_NE(c["domain"]["euler_characteristic_of_kept_components"], c["domain"]["euler_characteristic_meshed"])
      << "the count is right: the test needs another position";
  EXPECT_EQ(c["features"]["missed_curves"], 0);
}

TEST_F(Program, BodiesWithSharpEdgesHaveThemInTheMesh) {
  const Body bodies[] = {
      {"max(abs(x),abs(y),abs(z))-1", 12, 8, 6, 8, 1e-10, .7},
      {"max(x^2+y^2-1,abs(z)-1)", 2, 0, 3, 2 * kPi, .03, .7},
      // An eighth of a ball is cut out of a corner.
      {"max(max(abs(x),abs(y),abs(z))-1,1-(x-1)^2-(y-1)^2-(z-1)^2)", 15, 10, 7, 8 - kPi / 6, .01, .65}};
  for (const Body& body : bodies) {
    SCOPED_TRACE(body.formula);
    const Result r = run("mesh --implicit '" + std::string(body.formula) + "'" + kBox + "--h .2 -o body --strict -v");
    ASSERT_EQ(r.code, 0) << r.out << r.err;
    const Json c = Json::parse(content(folder / "body/certificate.json"));
    const Json& f = c["features"];
    EXPECT_EQ(c["verdict"], "pass");
    EXPECT_EQ(f["curves"], body.curves);
    EXPECT_EQ(f["corners"], body.corners);
    EXPECT_EQ(f["patches"], body.patches);
    EXPECT_EQ(f["missed_curves"], 0);
    EXPECT_EQ(f["missed_corners"], 0);
    EXPECT_EQ(f["faces_without_patch"], 0);
    EXPECT_EQ(f["missed_length"], 0.);
    EXPECT_LE(f["max_vertex_distance_over_h"].get<double>(), 1e-8);
    EXPECT_LE(f["max_curve_distance_over_h"].get<double>(), .3);
    EXPECT_NEAR(c["volume"].get<double>(), body.volume, body.tolerance * body.volume);
    EXPECT_EQ(c["boundary"]["genus"], 0);
    EXPECT_GT(c["boundary"]["min_cos_normal"].get<double>(), .85);
    EXPECT_LE(c["boundary"]["max_vertex_distance_over_h"].get<double>(), 1e-8);
    EXPECT_GE(c["quality"]["min"].get<double>(), body.least_quality);
    EXPECT_GE(f["wedge_quality"].get<double>(), c["quality"]["min"].get<double>());
    EXPECT_TRUE(c["resolution"]["too_thin"].empty()) << "the wedges at edges are not thin";
    EXPECT_NE(r.out.find("all in the mesh"), std::string::npos) << r.out;

    // The files of the stages and an independent check of the last.
    for (const char* file : {"omega_h.vtu", "projected.vtu", "mesh.vtu"}) {
      const MeshFile mesh = read_tet_mesh(folder / "body/3-mesh" / file);
      EXPECT_EQ(std::get<std::vector<std::int64_t>>(mesh.cell_data.at("background_tet")).size(), mesh.mesh.C.size());
      EXPECT_EQ(std::get<std::vector<std::int64_t>>(mesh.point_data.at("background_vertex")).size(),
                mesh.mesh.V.size());
    }
    EXPECT_EQ(run("check body/3-mesh/mesh.vtu --against body --strict").code, 0);
    EXPECT_NE(run("check body/3-mesh/omega_h.vtu --against body").code, 0);
  }
}

TEST_F(Program, ABodyWithSharpEdgesIsTheSameInEveryRun) {
  const std::string made = "mesh --implicit 'max(x^2+y^2-1,abs(z)-1)'" + kBox + "--h .3 --no-report ";
  ASSERT_EQ(run(made + "--threads 1 -o one").code, 0);
  ASSERT_EQ(run(made + "--threads 4 -o four").code, 0);
  for (const char* file : {"omega_h.vtu", "projected.vtu", "mesh.vtu"})
    EXPECT_EQ(content(folder / "one/3-mesh" / file), content(folder / "four/3-mesh" / file)) << file;
  EXPECT_EQ(without_run(folder / "one/certificate.json"), without_run(folder / "four/certificate.json"));
}

// A max whose second part never bounds the body, or is the first one, leaves a smooth body.
TEST_F(Program, AMaxWithoutAnEdgeIsASmoothBody) {
  for (const char* formula : {"max(x^2+y^2+z^2-1,x^2+y^2+z^2-1)", "max(x^2+y^2+z^2-1,x^2+y^2+z^2-4)",
                              "min(x^2+y^2+z^2-1,x^2+y^2+(z-9)^2-1)"}) {
    SCOPED_TRACE(formula);
    const Result r = run("mesh --implicit '" + std::string(formula) + "'" + kBox + "--h .3 -o ball --no-report");
    ASSERT_EQ(r.code, 0) << r.out << r.err;
    const Json c = Json::parse(content(folder / "ball/certificate.json"));
    EXPECT_EQ(c["verdict"], "pass");
    EXPECT_EQ(c.value("/features/curves"_json_pointer, 0), 0);
    EXPECT_EQ(c.contains("features"), std::string(formula) != "max(x^2+y^2+z^2-1,x^2+y^2+z^2-1)");
  }
}

// A groove of a hundredth of an edge: the mesh is made all the same, and the certificate says what it lacks.
TEST_F(Program, EdgesThatTheMeshLacksAreNamedWithTheirPlace) {
  const Result groove = run("mesh --implicit 'max(max(abs(x),abs(y),abs(z))-1,min(.003-abs(x),z-.4))'" + kBox +
                            "--h .25 -o groove --no-report --effort 1");
  ASSERT_TRUE(groove.code == 0 || groove.code == 6) << groove.out << groove.err;
  const Json c = Json::parse(content(folder / "groove/certificate.json"));
  EXPECT_TRUE(c["valid"]);
  const Json& f = c["features"];
  EXPECT_GT(f["missed_curves"].get<int>(), 0);
  EXPECT_GT(f["missed_length"].get<double>(), 0);
  EXPECT_EQ(run("run groove --strict").code == 0, false);
}

/// The node sets of an .inp file by name, and its nodes.
struct InpFile {
  std::map<std::string, std::vector<std::size_t>> sets;
  std::vector<Vec3> nodes;

  explicit InpFile(const fs::path& file) {
    std::istringstream in(content(file));
    std::string line, set;
    bool in_nodes = false;
    while (std::getline(in, line)) {
      if (line.starts_with("*")) {
        in_nodes = line == "*NODE";
        set = line.starts_with("*NSET, NSET=") ? line.substr(12) : "";
        continue;
      }
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream numbers(line);
      std::size_t id = 0;
      if (in_nodes) {
        Vec3 x;
        numbers >> id >> x[0] >> x[1] >> x[2];
        nodes.push_back(x);
      }
      if (!set.empty())
        while (numbers >> id) sets[set].push_back(id - 1);
    }
  }
};

TEST_F(Program, PatchesAndCurvesOfACubeAreSetsOfExportedFiles) {
  const Result r = run("mesh --implicit 'max(abs(x),abs(y),abs(z))-1'" + kBox +
                       "--h .3 -o cube --no-report --export inp,msh,msh22,vtu,feb,cdb");
  ASSERT_EQ(r.code, 0) << r.err;
  const InpFile inp(folder / "cube/4-export/mesh.inp");
  const auto n_walls = [&](std::size_t node) {
    return std::count_if(inp.nodes[node].begin(), inp.nodes[node].end(),
                         [](double c) { return std::abs(std::abs(c) - 1) < 1e-9; });
  };
  int n_patches = 0, n_curves = 0;
  std::map<std::size_t, int> curves_at;
  for (const auto& [name, nodes] : inp.sets) {
    SCOPED_TRACE(name);
    if (name.starts_with("patch_")) {
      ++n_patches;
      for (const std::size_t v : nodes) EXPECT_GE(n_walls(v), 1);
    } else if (name.starts_with("curve_")) {
      ++n_curves;
      for (const std::size_t v : nodes) {
        EXPECT_GE(n_walls(v), 2);
        ++curves_at[v];
      }
    }
  }
  EXPECT_EQ(n_patches, 6);
  EXPECT_EQ(n_curves, 12);
  for (const auto& [node, n] : curves_at) EXPECT_EQ(n, n_walls(node) == 3 ? 3 : 1);
  EXPECT_EQ(std::count_if(curves_at.begin(), curves_at.end(), [](const auto& c) { return c.second == 3; }), 8);
  for (const char* file : {"mesh.inp", "mesh.msh", "mesh_22.msh", "mesh.vtu", "mesh.feb", "mesh.cdb"}) {
    std::string text = content(folder / "cube/4-export" / file);
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const char* name : {"patch_6", "curve_12"}) EXPECT_NE(text.find(name), std::string::npos) << file << name;
  }
  const std::string lines = content(folder / "cube/3-mesh/features.vtp");
  EXPECT_NE(lines.find("NumberOfLines=\"12\""), std::string::npos);
  // A solver's reader sees the same tets.
  const MeshFile mesh = read_tet_mesh(folder / "cube/3-mesh/mesh.vtu");
  for (const char* file : {"mesh.msh", "mesh_22.msh"})
    EXPECT_EQ(read_tet_mesh(folder / "cube/4-export" / file).mesh.C.size(), mesh.mesh.C.size()) << file;
  // Flags of the user go before.
  ASSERT_EQ(run("export cube --format inp --patch-angle 100").code, 0);
  EXPECT_EQ(InpFile(folder / "cube/4-export/mesh.inp").sets.count("patch_1"), 0U);
}

TEST_F(Program, InspectCountsTheEdgesOfAFormula) {
  const Result r = run("inspect --implicit 'max(abs(x),abs(y),abs(z))-1'" + kBox + "--h .2 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json found = Json::parse(r.out)["inspection"];
  EXPECT_EQ(found["edges"]["curves"], 12);
  EXPECT_EQ(found["edges"]["corners"], 8);
  EXPECT_EQ(found["edges"]["patches"], 6);
  EXPECT_EQ(found["edges"]["faults"], 0);
  EXPECT_NEAR(found["edges"]["length"].get<double>(), 24, 1e-6);
  EXPECT_NEAR(found["edges"]["min_angle_deg"].get<double>(), 90, 1e-6);
  EXPECT_EQ(found["pieces"], 1);
  EXPECT_NEAR(found["area"].get<double>(), 24, 3);
  EXPECT_NE(run("inspect --implicit 'x^2+y^2+z^2-1'" + kBox).out.find("smooth"), std::string::npos);
  EXPECT_EQ(run("inspect").code, 2);
  EXPECT_EQ(run("inspect egg.ply --implicit 'x^2+y^2+z^2-1'" + kBox).code, 2);
}

TEST_F(Program, OptionsThatSharpEdgesExcludeAreRefusedByName) {
  const std::string cylinder = "mesh --implicit 'max(x^2+y^2-1,abs(z)-1)'" + kBox + "--h .3 -o a ";
  for (const char* option : {"--order 2", "--mode paper", "--complement --box-walls"}) {
    const Result r = run(cylinder + option);
    EXPECT_EQ(r.code, 2) << option;
    EXPECT_NE(r.err.find("sharp edges"), std::string::npos) << r.err;
  }
  const Result both_sides = run("mesh --implicit 'max(x^2+y^2+z^2-1,-(x^2+y^2+z^2-1))'" + kBox + "--h .3 -o a");
  EXPECT_EQ(both_sides.code, 2);
  EXPECT_NE(both_sides.err.find("both of its sides"), std::string::npos) << both_sides.err;
  const Result product = run("mesh --implicit 'x*max(y,z)-1'" + kBox + "--h .3 -o a");
  EXPECT_EQ(product.code, 2) << product.err;
  const Result nothing = run("mesh --implicit 'max(x-1,2-x)'" + kBox + "--h .3 -o a");
  EXPECT_EQ(nothing.code, 5) << nothing.err;
}

}  // namespace
}  // namespace umtet
