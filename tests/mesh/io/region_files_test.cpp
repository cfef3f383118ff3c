// Meshes of several regions in files: what is written, and what is read back.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/io/file_regions.h"
#include "mesh/io/solver_files.h"
#include "tests/support/shell.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kNames = {"outside", "bone", "marrow"};

class RegionFiles : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  std::string text_of(const std::string& name, const std::function<void(const fs::path&)>& write) const {
    write(folder / name);
    std::ifstream in(folder / name, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }
  MeshFile read(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return read_tet_mesh(folder / name);
  }

  const fs::path folder = fs::path(::testing::TempDir()) / ("umtet_region_files_" + std::to_string(::getpid()));
};

/// A block of 4 x 4 x 4 cubes. Bone is its middle two layers without the cubes of marrow, which touch the outside, too.
SolverMesh block(bool has_outside = true) {
  const auto region_of = [](int i, int j, int k) {
    const bool is_inner = std::min({i, j, k}) >= 1 && std::max({i, j, k}) <= 2;
    return !is_inner ? 0 : i == 2 && j == 2 ? 2 : 1;
  };
  TetMesh tets = testing::cubes(4, [&](int i, int j, int k) { return has_outside || region_of(i, j, k) > 0; });
  std::vector<int> region;
  for (const Tet& t : tets.C) {
    const Vec3 x = (tets.V[t[0]] + tets.V[t[1]] + tets.V[t[2]] + tets.V[t[3]]) / 4;
    region.push_back(region_of(static_cast<int>(x[0]), static_cast<int>(x[1]), static_cast<int>(x[2])));
  }
  testing::perturb(tets, .1, 7);
  SolverMesh mesh = solver_mesh(tets);
  set_regions(mesh, region, kNames);
  return mesh;
}

std::map<std::string, int> faces_by_patch(const SolverMesh& mesh) {
  std::map<std::string, int> n;
  for (const int p : mesh.face_patch) ++n[mesh.patches[p].name];
  return n;
}

TEST_F(RegionFiles, PatchesAreWallsAndInterfaces) {
  const SolverMesh mesh = block();
  ASSERT_EQ(mesh.regions.size(), 3U);
  EXPECT_EQ(mesh.regions[0].number, 3);  // outside
  EXPECT_EQ(mesh.regions[2].name, "marrow");
  EXPECT_EQ(mesh.regions[2].number, 2);
  // Two triangles a square: 6 walls of 16; marrow is 1 x 1 x 2, and bone the rest of 2 x 2 x 2.
  EXPECT_EQ(
      faces_by_patch(mesh),
      (std::map<std::string, int>{
          {"walls", 6 * 16 * 2}, {"bone|marrow", 4 * 2}, {"bone|outside", (24 - 6) * 2}, {"marrow|outside", 6 * 2}}));
  EXPECT_EQ(boundary_nodes(mesh).size(), 125U - 27U);
  // Faces of an interface point out of the region that is named first.
  std::map<std::string, Vec3> sum;
  std::map<std::string, std::set<std::string>> region_behind;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    const Vec3 &a = mesh.nodes[face[0]], &b = mesh.nodes[face[1]], &c = mesh.nodes[face[2]];
    const std::string& name = mesh.patches[mesh.face_patch[f]].name;
    sum.try_emplace(name, Vec3::Zero()).first->second += (b - a).cross(c - a) / 2;
    region_behind[name].insert(mesh.regions[mesh.part_of(mesh.face_tet[f])].name);
  }
  for (const auto& [name, regions] : region_behind) {
    ASSERT_EQ(regions.size(), 1U) << name;
    EXPECT_EQ(*regions.begin(), name == "walls" ? "outside" : name.substr(0, name.find('|')));
  }
  EXPECT_LT(sum["walls"].norm(), 1e-12);
  EXPECT_LT((sum["bone|outside"] + sum["marrow|outside"]).norm(), 1e-12);
  EXPECT_LT((sum["bone|outside"] + sum["bone|marrow"]).norm(), 1e-12);
  EXPECT_GT(sum["bone|marrow"].norm(), 1);
}

TEST_F(RegionFiles, WithoutAnOutsideTheBoundaryIsNamedAfterIt) {
  const SolverMesh mesh = block(false);
  EXPECT_EQ(
      faces_by_patch(mesh),
      (std::map<std::string, int>{{"bone|marrow", 4 * 2}, {"bone|outside", (24 - 6) * 2}, {"marrow|outside", 6 * 2}}));
  ASSERT_EQ(mesh.regions.size(), 2U);
  SolverMesh again = mesh;  // former interfaces are replaced
  std::vector<int> all(mesh.n_tets(), 1);
  set_regions(again, all, kNames);
  EXPECT_EQ(faces_by_patch(again), (std::map<std::string, int>{{"bone|outside", 24 * 2}}));
}

TEST_F(RegionFiles, EveryFormatThatIsReadKeepsTheRegions) {
  const SolverMesh mesh = block();
  const std::map<std::string, std::function<void(const fs::path&)>> formats = {
      {"a.vtu", [&](const fs::path& p) { write_vtu(p, mesh); }},
      {"a22.msh", [&](const fs::path& p) { write_msh22(p, mesh, MshEncoding::Ascii); }},
      {"b22.msh", [&](const fs::path& p) { write_msh22(p, mesh, MshEncoding::Binary); }},
      {"a41.msh", [&](const fs::path& p) { write_msh41(p, mesh, MshEncoding::Ascii); }},
      {"b41.msh", [&](const fs::path& p) { write_msh41(p, mesh, MshEncoding::Binary); }},
      {"a.mesh", [&](const fs::path& p) { write_medit(p, mesh); }},
      {"a.inp", [&](const fs::path& p) { write_inp(p, mesh); }}};
  for (const auto& [name, write] : formats) {
    write(folder / name);
    const MeshFile file = read_tet_mesh(folder / name);
    const std::optional<FileRegions> found = file_regions(file);
    ASSERT_TRUE(found) << name;
    const bool has_names = name != "a.mesh";
    if (has_names) {
      EXPECT_EQ(found->names[0], "outside") << name;
      EXPECT_TRUE(found->has_outside) << name;
    }
    std::map<std::string, std::size_t> n;
    for (const int r : found->of_tet) ++n[found->names[static_cast<std::size_t>(r)]];
    const auto called = [&](const char* region, const char* number) { return has_names ? region : number; };
    EXPECT_EQ(n, (std::map<std::string, std::size_t>{
                     {called("bone", "1"), 6 * 6}, {called("marrow", "2"), 6 * 2}, {called("outside", "3"), 6 * 56}}))
        << name;
  }
}

TEST_F(RegionFiles, MeshioFindsThePartsAndPatches) {
  if (!test::succeeds(std::string(test::kPython) + " -c 'import meshio, h5py'")) GTEST_SKIP() << "no meshio";
  const SolverMesh mesh = block();
  write_msh41(folder / "a.msh", mesh, MshEncoding::Binary);
  write_inp(folder / "a.inp", mesh);
  write_hdf5(folder / "a.h5", mesh);
  write_xdmf(folder / "a.xdmf", mesh, "a.h5");
  write_boundary_xdmf(folder / "b.xdmf", mesh, "a.h5");
  std::ofstream(folder / "look.py") << R"(
import meshio, numpy as np
m = meshio.read("a.msh")
names = {tuple(v): k for k, v in m.field_data.items()}
count = {}
for block, tags in zip(m.cells, m.cell_data["gmsh:physical"]):
    for tag in np.unique(tags):
        key = names[int(tag), 3 if block.type == "tetra" else 2]
        count[key] = count.get(key, 0) + int((tags == tag).sum())
assert count == {"bone": 36, "marrow": 12, "outside": 336, "walls": 192, "bone|marrow": 8, "bone|outside": 36,
                 "marrow|outside": 12}, count
m = meshio.read("a.inp")
sizes = {k: sum(len(b) for b in v) for k, v in m.cell_sets.items()}
assert sizes == {"bone": 36, "marrow": 12, "outside": 336}, sizes
assert len(m.point_sets["bone|marrow"]) == 9, m.point_sets
m = meshio.read("a.xdmf")
assert np.unique(m.cell_data["region"][0], return_counts=True)[1].tolist() == [36, 12, 336]
assert np.unique(meshio.read("b.xdmf").cell_data["patch"][0], return_counts=True)[1].tolist() == [192, 36, 8, 12]
)";
  const std::string said = test::shell("cd '" + folder.string() + "' && " + test::kPython + " look.py");
  EXPECT_TRUE(said.ends_with("exit 0\n")) << said;
}

TEST_F(RegionFiles, PartsOfOtherFormats) {
  const SolverMesh mesh = block();
  const std::string feb = text_of("a.feb", [&](const fs::path& p) { write_feb(p, mesh); });
  for (const char* text : {"<Elements type=\"tet4\" name=\"bone\">", "<Elements type=\"tet4\" name=\"marrow\">",
                           "<Surface name=\"bone|marrow\">", "<NodeSet name=\"bone|outside\">", "<elem id=\"384\">"})
    EXPECT_NE(feb.find(text), std::string::npos) << text;
  EXPECT_EQ(feb.find("<elem id=\"385\">"), std::string::npos);
  const std::string cdb = text_of("a.cdb", [&](const fs::path& p) { write_cdb(p, mesh); });
  for (const char* text : {"CMBLOCK,bone,ELEM", "CMBLOCK,marrow,ELEM", "! component bone_marrow = bone|marrow",
                           "CMBLOCK,bone_marrow,NODE"})
    EXPECT_NE(cdb.find(text), std::string::npos) << text;
  const std::string bdf = text_of("a.bdf", [&](const fs::path& p) { write_nastran(p, mesh); });
  EXPECT_NE(bdf.find("$ umtet: tets, property 2 = marrow"), std::string::npos);
  EXPECT_THROW(write_msh41_piece(folder / "p.msh", mesh), std::invalid_argument);
}

TEST_F(RegionFiles, RegionsAreChecked) {
  SolverMesh mesh = block();
  const std::vector<int> zeros(mesh.n_tets(), 0);
  EXPECT_THROW(set_regions(mesh, {0}, kNames), std::invalid_argument);
  EXPECT_THROW(set_regions(mesh, std::vector<int>(mesh.n_tets(), 3), kNames), std::invalid_argument);
  for (const char* name : {"walls", "Boundary", "OUTSIDE", "a|b", "1", ""})
    EXPECT_THROW(set_regions(mesh, zeros, {"outside", name}), std::invalid_argument) << name;
  EXPECT_THROW(set_regions(mesh, zeros, {"outside", std::string(40, 'a')}), std::invalid_argument);
  EXPECT_EQ(problem_of_region_name(std::string(39, 'a')), "");
}

constexpr const char* kTwoTets =
    "*Heading\n** two tets\n*NODE\n1, 0., 0, 0\n2, 1D0, , \n3, 0, 1., 0\n4, 0, 0, 1.\n15, 1, 1, 1\n";

TEST_F(RegionFiles, SetsOfAbaqusAreRegions) {
  const auto names = [&](const std::string& elements) {
    const std::optional<FileRegions> found = file_regions(read("a.inp", kTwoTets + elements));
    std::vector<std::string> list;
    for (std::size_t t = 0; found && t < found->of_tet.size(); ++t)
      list.push_back(found->names[static_cast<std::size_t>(found->of_tet[t])]);
    return list;
  };
  using List = std::vector<std::string>;
  const std::string one = "*Element, type=C3D4, elset=A\n1, 1, 2, 3, 4\n7, 2, 3, 4,\n15\n";
  EXPECT_EQ(names(one), List());
  EXPECT_EQ(names("*ELEMENT, TYPE=C3D4, ELSET=a\n1, 1,2,3,4\n*ELEMENT,\nTYPE=DC3D4, ELSET=\"b c\"\n7, 2,3,4,15\n"),
            (List{"a", "b c"}));
  EXPECT_EQ(names(one + "*ELSET, ELSET=bone\n1,\n*ELSET, ELSET=marrow, GENERATE\n3, 9, 2\n*ELSET, ELSET=all\n1, 7\n"),
            (List{"bone", "marrow"}));
  // Sets that leave a tet out, or contain it twice, say nothing.
  EXPECT_EQ(names(one + "*ELSET, ELSET=bone\n1\n"), List());
  EXPECT_EQ(names(one + "*ELEMENT, TYPE=S3, ELSET=skin\n9, 1, 2, 3\n"), List());
  const auto refused = [&](const std::string& text, const std::string& reason) {
    try {
      read("b.inp", text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const MeshFileRefused& e) {
      EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
    }
  };
  refused(kTwoTets, "no tets");
  refused("1, 2\n", "no keyword");
  refused(kTwoTets + std::string("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3\n"), "ends in an element");
  refused(kTwoTets + std::string("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4, 5\n"), "more nodes");
  refused(kTwoTets + std::string("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, x\n"), "whole number");
  refused(kTwoTets + std::string("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 99\n"), "99");
  refused("*PART, NAME=a\n*PART, NAME=b\n", "second *PART");
}

TEST_F(RegionFiles, MarksOfOtherProgramsAreFound) {
  const SolverMesh mesh = block();
  const TetMesh tets = read("a.vtu", text_of("b.vtu", [&](const fs::path& p) { write_vtu(p, mesh); })).mesh;
  const auto marked = [&](const std::string& name, const FieldValues& values) {
    return file_regions({.mesh = tets, .point_data = {}, .cell_data = {{name, values}}});
  };
  std::vector<std::int64_t> marks(tets.C.size(), 42);
  EXPECT_FALSE(marked("region", marks));
  marks[3] = 7;
  const std::optional<FileRegions> found = marked("medit:ref", marks);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->names, (std::vector<std::string>{"outside", "7", "42"}));
  EXPECT_FALSE(found->has_outside);
  EXPECT_EQ(found->of_tet[3], 1);
  marks[3] = 0;
  EXPECT_TRUE(marked("label", marks)->has_outside);
  EXPECT_FALSE(marked("temperature", marks));
  EXPECT_FALSE(marked("label", std::vector<double>(tets.C.size(), .5)));
}

}  // namespace
}  // namespace umtet
