// The built program, from outside: files for solvers, and the labels of points in them.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>

#include "pipeline/case/exit_code.h"
#include "pipeline/output/boundary_patches.h"
#include "reconstruct/io/point_cloud_io.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/support/data_files.h"
#include "tests/support/shell.h"

namespace umtet {
namespace {

const std::string kAllFormats = "vtu,msh,msh22,mesh,inp,bdf,feb,cdb,xdmf,stl,obj,ply,pvtu,pmsh";

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder)) return names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

/// What an .inp file says, as its manual reads it.
struct Inp {
  std::map<int, Vec3> node;
  std::map<int, std::array<int, 4>> tet;
  std::map<std::string, std::set<int>> node_set;
  std::map<std::string, Vec3> area;  ///< of a surface: sum of the outward area vectors

  explicit Inp(const fs::path& file) {
    constexpr int kCorners[5][3] = {{}, {1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}};  // inwards
    std::ifstream in(file);
    std::string line, card, name;
    while (std::getline(in, line)) {
      if (line[0] == '*') {
        card = line.substr(0, line.find(','));
        const std::size_t at = line.find(card == "*NSET" ? "NSET=" : "NAME=");
        name = at == std::string::npos ? "" : line.substr(at + 5, line.find(',', at) - at - 5);
        continue;
      }
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      int id = 0;
      if (card == "*NODE" && words >> id) words >> node[id].x() >> node[id].y() >> node[id].z();
      if (card == "*ELEMENT" && words >> id) {
        for (int& v : tet[id]) words >> v;
      }
      while (card == "*NSET" && words >> id) node_set[name].insert(id);
      char s = 0;
      int side = 0;
      if (card != "*SURFACE" || !(words >> id >> s >> side)) continue;
      const Vec3 &a = node[tet[id][kCorners[side][0] - 1]], &b = node[tet[id][kCorners[side][1] - 1]],
                 &c = node[tet[id][kCorners[side][2] - 1]];
      area.try_emplace(name, Vec3::Zero()).first->second -= (b - a).cross(c - a) / 2;
    }
  }
};

/// What the formats in a .cdb file find; see read_cdb.py.
Json read_cdb(const fs::path& file) {
  const std::string out =
      test::shell(std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_cdb.py " + file.string());
  Json found = Json::parse(out.substr(0, out.find('\n')));
  EXPECT_TRUE(found["wrong"].empty()) << found["wrong"];
  return found;
}

class Export : public Program {
 protected:
  /// The egg, its lower part label 4, its upper part 2.
  void label_egg() {
    OrientedPointCloud egg = read_point_cloud(cloud).cloud;
    for (const Vec3& x : egg.points) egg.labels.push_back(x.z() < .1 ? 4 : 2);
    std::ofstream out(folder / "labelled.ply", std::ios::binary);
    write_ply(out, egg);
  }
};

TEST_F(Export, LabelsOfPointsBecomeSetsOfEveryFile) {
  label_egg();
  const Result r = run("run labelled.ply -o egg --tets 3000 --label-names 4=Feet,2=top --json --export " + kAllFormats);
  ASSERT_EQ(r.code, 0) << r.err;
  const fs::path out = folder / "egg/4-export";
  const std::set<std::string> expected = {
      "mesh.vtu",     "mesh_boundary.vtu", "mesh.msh",     "mesh_22.msh",        "mesh.mesh",    "mesh.inp",
      "mesh.bdf",     "mesh.h5",           "mesh.xdmf",    "mesh_boundary.xdmf", "mesh.stl",     "mesh.obj",
      "mesh.ply",     "mesh.Feet.stl",     "mesh.top.stl", "mesh.Feet.obj",      "mesh.top.obj", "mesh.Feet.ply",
      "mesh.top.ply", "mesh.pvtu",         "mesh_0.vtu",   "mesh_part_1.msh",    "mesh.feb",     "mesh.cdb"};
  EXPECT_EQ(names_in(out), expected);
  const std::string feb = test::shell(std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_feb.py " +
                                      (out / "mesh.feb").string());
  const Json of_febio = Json::parse(feb.substr(0, feb.find('\n')));
  EXPECT_TRUE(of_febio["wrong"].empty()) << of_febio["wrong"];
  const Json of_ansys = read_cdb(out / "mesh.cdb");
  EXPECT_EQ(of_ansys["element_sets"]["body"].size(), of_febio["tets"]);
  EXPECT_NEAR(of_ansys["volume"].get<double>(), of_febio["volume"].get<double>(), 1e-12);
  const Inp inp(out / "mesh.inp");
  for (const int i : inp.node_set.at("Feet")) EXPECT_LT(inp.node.at(i).z(), .3);
  for (const int i : inp.node_set.at("top")) EXPECT_GT(inp.node.at(i).z(), -.1);
  EXPECT_LT(inp.node_set.at("boundary").size(), inp.node_set.at("Feet").size() + inp.node_set.at("top").size());
  EXPECT_NEAR(inp.area.at("top").z() / 3.14159 / .8, 1, .1);  // the ellipse it is cut off at
  for (const auto& [name, nodes] : inp.node_set) {
    EXPECT_EQ(of_febio["sets"][name], Json(nodes)) << name;
    EXPECT_EQ(of_ansys["sets"][name], Json(nodes)) << name;
  }
  for (const auto& [name, area] : inp.area) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(of_febio["surfaces"][name]["area"][k].get<double>(), area[k], 1e-9) << name;
  }
  // Another program finds the same sets under the same names in all files.
  if (!test::succeeds(std::string(test::kPython) + " -c 'import meshio, h5py'")) GTEST_SKIP() << "no meshio";
  std::string command = std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_back.py";
  const std::vector<const char*> files = {"mesh.msh",          "mesh_22.msh",        "mesh.mesh", "mesh.bdf",
                                          "mesh_boundary.vtu", "mesh_boundary.xdmf", "mesh.inp",  "mesh.vtu",
                                          "mesh.xdmf",         "mesh_0.vtu"};
  for (const char* file : files) command.append(" ").append((out / file).string());
  std::istringstream lines(test::shell(command));
  std::string line;
  Json first;
  for (const char* file : files) {
    std::getline(lines, line);
    const Json found = Json::parse(line);
    if (first.is_null()) first = found;
    EXPECT_EQ(found["points"], first["points"]) << file;
    if (found["faces"] > 0) {
      EXPECT_EQ(found["area"].size(), 2u);
      for (const char* number : {"2", "4"}) {
        EXPECT_NEAR(found["area"].value(number, 0.), first["area"].value(number, -1.), 1e-8) << file;
      }
    } else {
      EXPECT_EQ(found["node_sets"]["Feet"], inp.node_set.at("Feet").size()) << file;
    }
    if (!found["names"].empty()) {
      EXPECT_EQ(found["names"]["Feet"], 4) << file;
    }
  }
}

TEST_F(Export, CurvedTetsStayCurved) {
  const Result r =
      run("mesh --implicit 'x^2+y^2+z^2-1' --box=-1.3,-1.3,-1.3,1.3,1.3,1.3 --tets 400 --order 2 -o ball "
          "--json --export vtu,msh,msh22,mesh,inp,cdb");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("FreeFEM finds no tets"), std::string::npos) << r.err;
  const Json made = Json::parse(r.out)["certificate"];
  const fs::path out = folder / "ball/4-export";
  for (const char* file : {"mesh.vtu", "mesh.msh", "mesh_22.msh", "mesh.mesh"}) {
    const Json found = Json::parse(run("check " + (out / file).string() + " --json").out)["check"];
    EXPECT_EQ(found["order"], 2) << file;
    EXPECT_NEAR(found["second_order"]["volume"].get<double>(), made["second_order"]["volume"].get<double>(), 1e-12)
        << file;
  }
  EXPECT_NE(content(out / "mesh.inp").find("TYPE=C3D10"), std::string::npos);
  const Json cdb = read_cdb(out / "mesh.cdb");
  EXPECT_EQ(cdb["type"], "187");
  EXPECT_NEAR(cdb["volume"].get<double>(), made["volume"].get<double>(), 1e-12);
  // Another program integrates over the same curved tets of a file for Ansys.
  if (!test::succeeds(std::string(test::kPython) + " -c 'import getfem'")) GTEST_SKIP() << "no getfem";
  std::ofstream(folder / "volume.py") << "import getfem, sys\n"
                                         "mesh = getfem.Mesh('import', 'cdb', sys.argv[1])\n"
                                         "rule = getfem.MeshIm(mesh, getfem.Integ('IM_TETRAHEDRON(6)'))\n"
                                         "print('volume', repr(getfem.asm('generic', rule, 0, '1', -1)))\n";
  const std::string said = test::shell(std::string(test::kPython) + " " + (folder / "volume.py").string() + " " +
                                       (out / "mesh.cdb").string());
  const std::size_t at = said.find("volume ");
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_NEAR(std::stod(said.substr(at + 7)), made["second_order"]["volume"].get<double>(), 1e-11);
}

TEST_F(Export, NamesAreCheckedBeforeAnythingIsMade) {
  label_egg();
  for (const char* names : {"4", "4=", "x=a", "4=a,4=b", "4=a,2=A", "4=body", "'4=a b'"}) {
    const Result r = run("run labelled.ply -o egg --tets 3000 --label-names " + std::string(names));
    EXPECT_EQ(r.code, 2) << names << r.err;
    EXPECT_FALSE(fs::exists(folder / "egg")) << names;
  }
  EXPECT_EQ(run("run labelled.ply -o egg --export in").code, 2);
  EXPECT_EQ(run("run labelled.ply -o egg --export inp --until level-set").code, 2);
  ASSERT_EQ(run("run labelled.ply -o egg --tets 3000 --label-names 4=Feet").code, 0);
  const Result none = run("export egg --format stl --label-names 5=Feet");
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("the labels are 2, 4"), std::string::npos) << none.err;
  // The names of the run hold until others are given.
  ASSERT_EQ(run("export egg --format stl").code, 0);
  EXPECT_TRUE(fs::exists(folder / "egg/4-export/mesh.Feet.stl"));
  EXPECT_TRUE(fs::exists(folder / "egg/4-export/mesh.patch_2.stl"));
  std::ofstream(folder / "egg/4-export/load.inp") << "of the user";
  ASSERT_EQ(run("export egg --format stl --label-names 2=top").code, 0);
  const std::set<std::string> renamed = {"load.inp", "mesh.stl", "mesh.patch_4.stl", "mesh.top.stl"};
  EXPECT_EQ(names_in(folder / "egg/4-export"), renamed);
  const Result again = run("run egg --tets 2000 -q");
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(names_in(folder / "egg/4-export"), std::set<std::string>{"load.inp"});  // the rest was of the former mesh
}

TEST_F(Export, WithoutLabelsPiecesAndAnglesMakePatches) {
  const std::string shell =
      "mesh --implicit '(x^2+y^2+z^2-1)*(x^2+y^2+z^2-0.25)' --box=-1.3,-1.3,-1.3,1.3,1.3,1.3 --h .12 -o shell "
      "--export inp";
  const Result r = run(shell);
  ASSERT_EQ(r.code, 0) << r.err;
  const Inp inp(folder / "shell/4-export/mesh.inp");
  ASSERT_EQ(inp.node_set.size(), 3u);
  for (const int i : inp.node_set.at("boundary_1")) EXPECT_NEAR(inp.node.at(i).norm(), 1, 1e-6);
  for (const int i : inp.node_set.at("boundary_2")) EXPECT_NEAR(inp.node.at(i).norm(), .5, 1e-6);
  EXPECT_EQ(run("export shell --format inp --label-names 1=a").code, 2);
  // A die: at this h faces across its edges meet at more than 35 degrees, faces of a side at less.
  ASSERT_EQ(run("mesh --implicit 'x^40+y^40+z^40-1' --box=-1.9,-1.9,-1.9,1.9,1.9,1.9 --h .25 -o die --export inp "
                "--patch-angle 35")
                .code,
            0);
  const Inp die(folder / "die/4-export/mesh.inp");
  Vec3 sum = Vec3::Zero();
  for (int p = 1; p <= 6; ++p) {
    const Vec3& side = die.area.at("region_" + std::to_string(p));
    EXPECT_GT(side.cwiseAbs().maxCoeff(), 3);
    EXPECT_GT(side.cwiseAbs().maxCoeff(), .99 * side.norm());
    sum += side;
  }
  EXPECT_LT(sum.norm(), .3);
}

TEST_F(Export, FlatPartsMakePatchesWhereEdgesAreRound) {
  const auto box = [](int p) {
    return "x^" + std::to_string(p) + "+y^" + std::to_string(p) + "+z^" + std::to_string(p);
  };
  ASSERT_EQ(run("mesh --implicit '" + box(12) +
                "-1' --box=-1.9,-1.9,-1.9,1.9,1.9,1.9 --h .12 -o die --export inp "
                "--patch-planar 8")
                .code,
            0);
  const Inp die(folder / "die/4-export/mesh.inp");
  EXPECT_EQ(die.area.size(), 8u);  // with the whole boundary
  for (int p = 1; p <= 6; ++p) {
    const Vec3& side = die.area.at("plane_" + std::to_string(p));
    EXPECT_GT(side.cwiseAbs().maxCoeff(), 1.2);
    EXPECT_GT(side.cwiseAbs().maxCoeff(), .99 * side.norm());
  }
  EXPECT_LT(die.area.at("rest").norm(), .1);
  // A ball has no plane: its only piece is one patch.
  ASSERT_EQ(run(ball).code, 0);
  const Result r = run("export ball --format inp --patch-planar 5");
  EXPECT_EQ(r.code, 0);
  EXPECT_NE(r.err.find("no part of the boundary is flat within 5 degrees"), std::string::npos) << r.err;
  EXPECT_EQ(Inp(folder / "ball/4-export/mesh.inp").area.size(), 1u);
}

TEST_F(Export, ADiskThatIsFullAtAnyPointLeavesNoFileAndAValidCase) {
  ASSERT_EQ(run(ball).code, 0);
  const auto before = files_of("ball");
  ASSERT_EQ(run("export ball --format " + kAllFormats).code, 0);
  std::map<std::string, std::uintmax_t> size;
  for (const std::string& name : names_in(folder / "ball/4-export"))
    size[name] = fs::file_size(folder / "ball/4-export" / name);
  const std::map<std::string, std::string> largest = {
      {"vtu", "mesh.vtu"}, {"msh", "mesh.msh"}, {"msh22", "mesh_22.msh"}, {"mesh", "mesh.mesh"},
      {"inp", "mesh.inp"}, {"bdf", "mesh.bdf"}, {"xdmf", "mesh.h5"},      {"stl", "mesh.stl"},
      {"obj", "mesh.obj"}, {"ply", "mesh.ply"}, {"pvtu", "mesh_0.vtu"},   {"pmsh", "mesh_part_1.msh"},
      {"cdb", "mesh.cdb"}, {"feb", "mesh.feb"}};
  for (const auto& [format, file] : largest) {
    for (const double part : {0., .5, 1.}) {
      fs::remove_all(folder / "ball/4-export");
      // In blocks of 512 bytes, as the shell counts.
      const auto blocks = static_cast<long>(part * static_cast<double>(size.at(file)) / 512 - (part > .9 ? 1 : 0));
      const Result r = run("export ball --format " + format, "ulimit -f " + std::to_string(std::max(0L, blocks)) + ";");
      EXPECT_EQ(r.code, 7) << format << ' ' << blocks;
      EXPECT_TRUE(names_in(folder / "ball/4-export").empty()) << format << ' ' << blocks;
    }
  }
  fs::remove_all(folder / "ball/4-export");
  EXPECT_EQ(files_of("ball"), before);
  EXPECT_NE(run(ball).err.find("nothing to do"), std::string::npos);
}

/// The last three numbers behind `head` in what CalculiX prints.
Vec3 total_force(const std::string& dat, const std::string& set) {
  const std::size_t at = dat.find("for set " + set);
  if (at == std::string::npos) return Vec3::Constant(NAN);
  std::istringstream in(dat.substr(dat.find('\n', at)));
  Vec3 f = Vec3::Constant(NAN);
  in >> f.x() >> f.y() >> f.z();
  return f;
}

TEST_F(Export, ADuckWithLabelsCarriesALoadInCalculix) {
  if (!test::succeeds("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  OrientedPointCloud duck = read_point_cloud(test::committed_cloud("duck.ply")).cloud;
  Eigen::AlignedBox3d box;
  for (const Vec3& x : duck.points) box.extend(x);
  // Labels of a tenth at each end of the longest side; the rest is 0.
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  for (const Vec3& x : duck.points) {
    const double s = (x[axis] - box.min()[axis]) / box.sizes()[axis];
    duck.labels.push_back(s < .1 ? 1 : s > .8 ? 2 : 0);
  }
  std::ofstream out(folder / "labelled.ply", std::ios::binary);
  write_ply(out, duck);
  out.close();
  const Result r = run("run labelled.ply -o duck --tets 4000 --label-names 1=Tail,2=bill --export inp,msh");
  ASSERT_EQ(r.code, 0) << r.err;
  std::ofstream(folder / "load.inp") << "*INCLUDE, INPUT=duck/4-export/mesh.inp\n"
                                        "*MATERIAL, NAME=rubber\n*ELASTIC\n1000., 0.3\n"
                                        "*SOLID SECTION, ELSET=body, MATERIAL=rubber\n"
                                        "*STEP\n*STATIC\n*BOUNDARY\nTail, 1, 3\n"
                                        "*DSLOAD\nbill, P, 2.\n*CLOAD\nbill, 2, 0.125\n"
                                        "*NODE PRINT, NSET=Tail, TOTALS=ONLY\nRF\n*END STEP\n";
  const std::string said = test::shell("cd '" + folder.string() + "' && ccx load");
  ASSERT_NE(said.find("Job finished"), std::string::npos) << said;
  EXPECT_EQ(said.find("*ERROR"), std::string::npos) << said;
  const Inp inp(folder / "duck/4-export/mesh.inp");
  EXPECT_LT(inp.area.at("boundary").norm(), 1e-9);  // closed: S1 to S4 are the outer faces
  Vec3 load = -2. * inp.area.at("bill");            // a pressure pushes inwards
  load.y() += .125 * static_cast<double>(inp.node_set.at("bill").size());
  const Vec3 reaction = total_force(content(folder / "load.dat"), "TAIL");
  EXPECT_LT((reaction + load).norm(), 1e-6 * load.norm()) << reaction.transpose() << " for " << load.transpose();
  RecordProperty("relative_error", std::to_string((reaction + load).norm() / load.norm()));
  EXPECT_GT(inp.area.at("bill").norm(), 1e-3 * box.sizes()[axis] * box.sizes()[axis]);
}

TEST(LabelNames, AreReadByLabel) {
  EXPECT_EQ(parse_label_names("1=feet,-2=Head"), (std::map<int, std::string>{{-2, "Head"}, {1, "feet"}}));
  EXPECT_TRUE(parse_label_names("").empty());
  EXPECT_THROW(parse_label_names("1=feet,,"), UsageError);
}

}  // namespace
}  // namespace umtet
