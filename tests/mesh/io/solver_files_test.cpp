#include "mesh/io/solver_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "mesh/io/detail/solvers/fixed_width.h"
#include "mesh/io/msh_piece.h"
#include "mesh/patches/patches.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/shell.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Scratch {
  fs::path folder = fs::path(::testing::TempDir()) / ("umtet_solver_files_" + std::to_string(::getpid()));
  Scratch() { fs::create_directories(folder); }
  ~Scratch() { fs::remove_all(folder); }
};

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// A block of cubes with all bits of its coordinates in use, its left side "Feet", its right side "head-2".
SolverMesh block(int n = 3) {
  TetMesh tets = testing::cubes(n, [](int, int, int) { return true; });
  testing::perturb(tets, 0.1, 5);
  SolverMesh mesh = solver_mesh(tets);
  std::vector<int> patch;
  for (const Vec3& x : face_geometry(mesh.nodes, mesh.triangles()).centroid)
    patch.push_back(x.x() < .2 ? 2 : x.x() > n - .2 ? 0 : 1);
  set_patches(mesh, patch, {{"head-2", 12}, {"surface", 1}, {"Feet", 7}});
  mesh.cell_data["mean_ratio"] = std::vector<double>(mesh.n_tets(), .5);
  mesh.point_data["background_vertex"] = std::vector<std::int64_t>(mesh.nodes.size(), std::int64_t{1} << 60);
  return mesh;
}

/// Boundary data of one component and of three, of some nodes.
void add_boundary_data(SolverMesh& mesh) {
  std::vector<double> heat(mesh.nodes.size(), std::nan(""));
  std::vector<Vec3> colour(mesh.nodes.size(), Vec3::Constant(std::nan("")));
  for (const int i : boundary_nodes(mesh)) {
    heat[i] = 20 + mesh.nodes[i].x();
    colour[i] = mesh.nodes[i];
  }
  mesh.boundary_data = {{"heat", heat}, {"colour", colour}};
}

/// One tet of ten nodes, its four faces in two patches.
SolverMesh quadratic() {
  std::vector<Vec3> x = {{0, 0, 0}, {1.25, 0, 0}, {.5, 1.5, 0}, {.25, .5, 1.75}};
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) x.push_back((x[a] + x[b]) / 2);
  SolverMesh mesh = solver_mesh(x, 10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  set_patches(mesh, {0, 1, 1, 0}, {{"Feet", 7}, {"head", 3}});
  return mesh;
}

struct Format {
  std::string file;
  std::function<void(const fs::path&, const SolverMesh&)> write;
};

std::vector<Format> formats() {
  using M = const SolverMesh&;
  using P = const fs::path&;
  return {{"a.vtu", [](P p, M m) { write_vtu(p, m); }},
          {"faces.vtu", write_boundary_vtu},
          {"a22.msh", [](P p, M m) { write_msh22(p, m, MshEncoding::Ascii); }},
          {"b22.msh", [](P p, M m) { write_msh22(p, m, MshEncoding::Binary); }},
          {"a41.msh", [](P p, M m) { write_msh41(p, m, MshEncoding::Ascii); }},
          {"b41.msh", [](P p, M m) { write_msh41(p, m, MshEncoding::Binary); }},
          {"a.mesh", write_medit},
          {"a.inp", write_inp},
          {"a.bdf", write_nastran},
          {"a.feb", write_feb},
          {"a.cdb", write_cdb},
          {"a.h5", write_hdf5},
          {"a.xdmf", [](P p, M m) { write_xdmf(p, m, "a.h5"); }},
          {"faces.xdmf", [](P p, M m) { write_boundary_xdmf(p, m, "a.h5"); }},
          {"a.stl", [](P p, M m) { write_boundary_surface(p, m, SurfaceFormat::Stl); }},
          {"feet.obj", [](P p, M m) { write_boundary_surface(p, m, SurfaceFormat::Obj, 0); }},
          {"a.ply", [](P p, M m) { write_boundary_surface(p, m, SurfaceFormat::Ply); }}};
}

/// What meshio finds in files, by name; see read_back.py.
std::map<std::string, Json> read_back(const std::vector<fs::path>& files) {
  std::string command = std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_back.py";
  for (const fs::path& file : files) command.append(" ").append(file.string());
  std::istringstream out(test::shell(command));
  std::map<std::string, Json> found;
  std::string line;
  for (const fs::path& file : files) {
    std::getline(out, line);
    const Json json = Json::parse(line, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << file << ": " << line << '\n' << out.str();
    if (json.is_discarded()) break;
    found[file.filename().string()] = json;
  }
  return found;
}

/// The areas of the patches (their corners) are those of the mesh.
void expect_areas(const Json& found, const SolverMesh& mesh, double tolerance) {
  std::map<std::string, double> area;
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    area[std::to_string(mesh.patches[mesh.face_patch[f]].number)] += faces.area[f];
  }
  ASSERT_EQ(found["area"].size(), area.size()) << found;
  for (const auto& [number, a] : area) EXPECT_NEAR(found["area"].value(number, 0.), a, tolerance * a) << found;
}

bool has(const std::string& name, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(), [&](const char* p) { return name.find(p) != std::string::npos; });
}

void expect_kept(const std::map<std::string, Json>& found, const SolverMesh& mesh) {
  std::map<std::string, std::size_t> nodes;
  const std::vector<std::vector<int>> of_patch = patch_nodes(mesh);
  for (std::size_t p = 0; p < of_patch.size(); ++p) nodes[mesh.patches[p].name] = of_patch[p].size();
  for (const auto& [name, json] : found) {
    SCOPED_TRACE(name + ": " + json.dump());
    const bool boundary_only = has(name, {"faces", "stl", "obj", "ply"});
    const bool tets_only = has(name, {"a.vtu", "inp", "a.xdmf"});
    EXPECT_EQ(json["tets"], boundary_only ? 0 : mesh.n_tets());
    EXPECT_TRUE(json["middles"]);
    if (has(name, {"stl", "obj", "ply"})) continue;
    EXPECT_EQ(json["points"], mesh.nodes.size());
    EXPECT_EQ(json["faces"], tets_only ? 0 : mesh.n_faces());
    if (!tets_only) expect_areas(json, mesh, has(name, {"bdf"}) ? 1e-9 : 1e-14);
    if (has(name, {"msh", "faces"})) {
      for (const MeshPart& patch : mesh.patches) EXPECT_EQ(json["names"].value(patch.name, -1), patch.number);
    }
    if (has(name, {"msh"})) {
      EXPECT_EQ(json["names"].value("body", -1), mesh.body.number);
    }
    if (tets_only) {
      for (const auto& [patch, n] : nodes) EXPECT_EQ(json["node_sets"].value(patch, std::size_t{0}), n);
    }
  }
}

TEST(SolverFiles, MeshioFindsWhatWasWritten) {
  if (!test::succeeds(std::string(test::kPython) + " -c 'import meshio, h5py'")) GTEST_SKIP() << "no meshio";
  for (const SolverMesh& mesh : {block(), quadratic()}) {
    const Scratch scratch;
    std::vector<fs::path> files;
    for (const Format& format : formats()) {
      format.write(scratch.folder / format.file, mesh);
      if (format.file == "a.mesh" && mesh.nodes_per_tet == 10) continue;  // meshio knows no MEDIT tets of ten nodes
      if (!has(format.file, {"h5", "feb", "cdb"})) files.push_back(scratch.folder / format.file);
    }
    const auto found = read_back(files);
    ASSERT_EQ(found.size(), files.size());
    expect_kept(found, mesh);
    EXPECT_EQ(found.at("a.stl").at("faces"), mesh.n_faces());
    EXPECT_EQ(found.at("feet.obj").at("faces"), std::count(mesh.face_patch.begin(), mesh.face_patch.end(), 0));
  }
}

TEST(SolverFiles, BoundaryDataAreFoundWhereAFormatHoldsThem) {
  if (!test::succeeds(std::string(test::kPython) + " -c 'import meshio, h5py'")) GTEST_SKIP() << "no meshio";
  for (SolverMesh mesh : {block(), quadratic()}) {
    const Scratch scratch;
    std::map<std::string, std::string> without;
    for (const Format& format : formats()) {
      format.write(scratch.folder / format.file, mesh);
      without[format.file] = bytes_of(scratch.folder / format.file);
    }
    add_boundary_data(mesh);
    std::vector<fs::path> files;
    for (const Format& format : formats()) {
      format.write(scratch.folder / format.file, mesh);
      const bool holds = has(format.file, {"vtu", "msh", "xdmf", "h5"});
      EXPECT_EQ(bytes_of(scratch.folder / format.file) != without.at(format.file), holds) << format.file;
      if (holds && format.file != "a.h5") files.push_back(scratch.folder / format.file);
    }
    double sum = 0, sum_colour = 0;
    for (const int i : boundary_nodes(mesh)) {
      sum += 20 + mesh.nodes[i].x();
      sum_colour += mesh.nodes[i].sum();
    }
    for (const auto& [name, json] : read_back(files)) {
      SCOPED_TRACE(name + ": " + json.dump());
      EXPECT_EQ(json["floats"]["heat"]["known"], boundary_nodes(mesh).size());
      EXPECT_NEAR(json["floats"]["heat"]["sum"].get<double>(), sum, 1e-12 * sum);
      EXPECT_EQ(json["floats"]["colour"]["known"], 3 * boundary_nodes(mesh).size());
      EXPECT_NEAR(json["floats"]["colour"]["sum"].get<double>(), sum_colour, 1e-12 * sum_colour);
    }
    mesh.boundary_data["heat"] = std::vector<double>(3);
    EXPECT_THROW(write_msh22(scratch.folder / "a.msh", mesh, MshEncoding::Ascii), std::invalid_argument);
  }
}

TEST(SolverFiles, GmshFindsWhatWasWritten) {
  if (!test::succeeds("gmsh --version")) GTEST_SKIP() << "gmsh is not installed";
  for (SolverMesh mesh : {block(), quadratic()}) {
    add_boundary_data(mesh);
    const Scratch scratch;
    std::vector<fs::path> files;
    for (const Format& format : formats()) {
      if (!has(format.file, {"msh", "mesh", "bdf"})) continue;
      const fs::path file = scratch.folder / format.file, again = scratch.folder / (format.file + ".again.msh");
      format.write(file, mesh);
      const std::string out =
          test::shell("gmsh " + file.string() + " -save -save_all -format msh22 -o " + again.string());
      EXPECT_EQ(out.find("Error"), std::string::npos) << out;
      EXPECT_EQ(out.find("Warning"), std::string::npos) << out;
      files.push_back(again);
    }
    for (auto& [name, json] : read_back(files)) {
      SCOPED_TRACE(name + ": " + json.dump());
      EXPECT_EQ(json["points"], mesh.nodes.size());
      EXPECT_EQ(json["tets"], mesh.n_tets());
      EXPECT_TRUE(json["middles"]);
      expect_areas(json, mesh, 1e-9);
      if (has(name, {"mesh.again", "bdf"})) continue;
      for (const MeshPart& patch : mesh.patches) EXPECT_EQ(json["names"].value(patch.name, -1), patch.number);
    }
  }
}

std::vector<int> from_one(std::vector<int> ids) {
  for (int& i : ids) ++i;
  return ids;
}

TEST(SolverFiles, AnXmlParserFindsInFilesOfFebioWhatWasWritten) {
  for (const SolverMesh& mesh : {block(2), quadratic()}) {
    const Scratch scratch;
    const fs::path file = scratch.folder / "a.feb";
    write_feb(file, mesh);
    const std::string out =
        test::shell(std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_feb.py " + file.string());
    const Json found = Json::parse(out.substr(0, out.find('\n')), nullptr, false);
    ASSERT_FALSE(found.is_discarded()) << out;
    EXPECT_TRUE(found["wrong"].empty()) << found["wrong"];
    EXPECT_EQ(found["type"], mesh.nodes_per_tet == 4 ? "tet4" : "tet10");
    EXPECT_EQ(found["part"], "body");
    EXPECT_EQ(found["tets"], mesh.n_tets());
    ASSERT_EQ(found["nodes"].size(), mesh.nodes.size());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      for (int k = 0; k < 3; ++k) EXPECT_EQ(found["nodes"][i][k].get<double>(), mesh.nodes[i][k]) << i;
    }
    const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
    const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
    ASSERT_EQ(found["sets"].size(), mesh.patches.size() + 1);
    ASSERT_EQ(found["surfaces"].size(), mesh.patches.size() + 1);
    EXPECT_EQ(found["sets"]["boundary"], from_one(boundary_nodes(mesh)));
    EXPECT_EQ(found["surfaces"]["boundary"]["facets"], mesh.n_faces());
    for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
      const std::string& name = mesh.patches[p].name;
      EXPECT_EQ(found["sets"][name], from_one(nodes[p]));
      Vec3 area = Vec3::Zero();
      for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
        if (mesh.face_patch[f] == static_cast<int>(p)) area += faces.area[f] * faces.normal[f];
      }
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(found["surfaces"][name]["area"][k].get<double>(), area[k], 1e-12);
    }
  }
}

/// What the formats in a .cdb file find; see read_cdb.py.
Json read_cdb(const fs::path& file) {
  const std::string out =
      test::shell(std::string(test::kPython) + " " UMTET_SOURCE_DIR "/tests/support/read_cdb.py " + file.string());
  Json found = Json::parse(out.substr(0, out.find('\n')), nullptr, false);
  EXPECT_FALSE(found.is_discarded()) << out;
  if (found.is_discarded()) return Json::object();
  EXPECT_TRUE(found["wrong"].empty()) << found["wrong"];
  return found;
}

TEST(SolverFiles, FortranFormatsFindInFilesOfAnsysWhatWasWritten) {
  for (SolverMesh mesh : {block(), quadratic()}) {
    mesh.nodes.front().x() = -1.2345678901234567e-101;
    const Scratch scratch;
    write_cdb(scratch.folder / "a.cdb", mesh);
    const Json found = read_cdb(scratch.folder / "a.cdb");
    EXPECT_EQ(found["type"], mesh.nodes_per_tet == 4 ? "285" : "187");
    ASSERT_EQ(found["nodes"].size(), mesh.nodes.size());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const double x = mesh.nodes[i][k];
        EXPECT_NEAR(found["nodes"][i][k].get<double>(), x, 5.01e-14 * std::abs(x)) << i;  // 14 digits
      }
    }
    ASSERT_EQ(found["elements"].size(), mesh.n_tets());
    for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
      const std::span<const int> tet = mesh.tet(t);
      EXPECT_EQ(found["elements"][t], from_one({tet.begin(), tet.end()})) << t;
    }
    std::vector<std::size_t> all(mesh.n_tets());
    for (std::size_t t = 0; t < all.size(); ++t) all[t] = t + 1;
    EXPECT_EQ(found["element_sets"], Json({{"body", all}}));
    std::map<std::string, std::vector<int>> expected = {{"boundary", from_one(boundary_nodes(mesh))}};
    const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
    for (std::size_t p = 0; p < nodes.size(); ++p) {
      std::string name = mesh.patches[p].name;
      std::replace(name.begin(), name.end(), '-', '_');
      expected[name] = from_one(nodes[p]);
    }
    EXPECT_EQ(found["sets"], Json(expected));
    if (mesh.nodes_per_tet == 4) {
      EXPECT_EQ(found["names"], Json({{"head-2", "head_2"}}));
    }
  }
}

TEST(SolverFiles, ComponentsOfAnsysHaveNamesOfTheirOwn) {
  SolverMesh mesh = block(2);
  const std::string stem(40, 'x');
  const std::vector<std::string> names = {"a-b", "a.b",      "A_b",      "all",      "Stat",
                                          "b",   stem + "1", stem + "2", stem + "3", std::string(32, 'y')};
  std::vector<MeshPart> patches;
  std::vector<int> patch(mesh.n_faces());
  for (std::size_t p = 0; p < names.size(); ++p) patches.push_back({names[p], static_cast<int>(p) + 1});
  for (std::size_t f = 0; f < patch.size(); ++f) patch[f] = static_cast<int>(f % patches.size());
  set_patches(mesh, patch, patches);
  const Scratch scratch;
  write_cdb(scratch.folder / "a.cdb", mesh);
  const Json found = read_cdb(scratch.folder / "a.cdb");
  EXPECT_EQ(found["names"], Json({{"a-b", "a_b_2"},
                                  {"a.b", "a_b_3"},
                                  {"all", "all_2"},
                                  {"Stat", "Stat_2"},
                                  {stem + "1", stem.substr(0, 32)},
                                  {stem + "2", stem.substr(0, 30) + "_2"},
                                  {stem + "3", stem.substr(0, 30) + "_3"}}));
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  ASSERT_EQ(found["sets"].size(), names.size() + 1);
  for (std::size_t p = 0; p < names.size(); ++p) {
    EXPECT_EQ(found["sets"][found["names"].value(names[p], names[p])], from_one(nodes[p])) << names[p];
  }
}

TEST(SolverFiles, SurfacesOfAbaqusAreTheFacesBehindTheirNumbers) {
  const Scratch scratch;
  const fs::path file = scratch.folder / "a.inp";
  // Corners of the faces, counted from 1, as the manuals of Abaqus and CalculiX list them.
  const int corners[5][3] = {{}, {1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}};
  const SolverMesh mesh = block(2);
  write_inp(file, mesh);
  std::map<std::string, Vec3> sum;  // of area vectors
  std::ifstream in(file);
  std::string line, name;
  while (std::getline(in, line)) {
    if (line[0] == '*') name = line.starts_with("*SURFACE, NAME=") ? line.substr(15, line.find(", TYPE") - 15) : "";
    const std::size_t side = line.find(", S");
    if (name.empty() || line[0] == '*' || side == std::string::npos) continue;
    const auto tet = mesh.tet(std::stoul(line) - 1);
    const auto& c = corners[std::stoi(line.substr(side + 3))];
    const Vec3 &a = mesh.nodes[tet[c[0] - 1]], &b = mesh.nodes[tet[c[1] - 1]], &d = mesh.nodes[tet[c[2] - 1]];
    sum.try_emplace(name, Vec3::Zero()).first->second += (b - a).cross(d - a) / 2;
  }
  ASSERT_EQ(sum.size(), 4u);
  const FaceGeometry faces = face_geometry(mesh.nodes, mesh.triangles());
  std::vector<Vec3> expected(3, Vec3::Zero());
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) expected[mesh.face_patch[f]] += faces.area[f] * faces.normal[f];
  for (std::size_t p = 0; p < 3; ++p) {
    // They run inwards in these lists.
    EXPECT_LT((sum.at(mesh.patches[p].name) + expected[p]).norm(), 1e-12) << p;
  }
  EXPECT_LT(sum.at("boundary").norm(), 1e-12);
}

TEST(SolverFiles, AFullDiskIsAnErrorAtAnyPointOfAnyWriter) {
  const SolverMesh mesh = block();
  const Scratch scratch;
  for (const Format& format : formats()) {
    const fs::path path = scratch.folder / format.file;
    format.write(path, mesh);
    const std::string whole = bytes_of(path);
    for (int part = 0; part < 8; ++part) {
      const std::uintmax_t limit = part == 7 ? whole.size() - 1 : whole.size() * part / 7;
      const test::FileSizeLimit full(limit);
      try {
        format.write(path, mesh);
        ADD_FAILURE() << format.file << " with room for " << limit << " of " << whole.size() << " bytes";
      } catch (const std::system_error& e) {
        EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
      }
    }
    format.write(path, mesh);
    EXPECT_EQ(bytes_of(path), whole) << format.file;  // equal meshes make equal bytes
  }
}

TEST(SolverFiles, MeshesThatContradictThemselvesAreNotWritten) {
  const Scratch scratch;
  SolverMesh mesh = block(1);
  mesh.face_patch.back() = 3;
  for (const Format& format : formats()) {
    EXPECT_THROW(format.write(scratch.folder / format.file, mesh), std::invalid_argument) << format.file;
    EXPECT_FALSE(fs::exists(scratch.folder / format.file));
  }
  mesh = block(1);
  mesh.patches[0].number = 100'000'000;
  EXPECT_THROW(write_nastran(scratch.folder / "a.bdf", mesh), std::invalid_argument);
}

TEST(SolverFiles, PartsForGmshHaveNoDataOfNodesBeyondItsNumbers) {
  const Scratch scratch;
  MshPiece piece;
  piece.nodes = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  piece.tets = {{0, 1, 2, 3}};
  piece.tet_number = {0};
  piece.boundary_data = {{"scan_heat", std::vector<double>(4, 1.)}};
  const std::int64_t last = std::numeric_limits<std::int32_t>::max() - std::int64_t{1};  // 2^31 - 1 from 1 on
  piece.node_number = {0, 1, 2, last};
  EXPECT_NO_THROW(write_msh41_piece(scratch.folder / "a.msh", piece));
  piece.node_number.back() = last + 1;
  EXPECT_THROW(write_msh41_piece(scratch.folder / "a.msh", piece), std::invalid_argument);
}

TEST(SetPatches, NamesAndNumbersThatAFormatWouldLoseAreRefused) {
  SolverMesh mesh = block(1);
  const std::vector<int> all(mesh.n_faces(), 0);
  for (const char* name : {"", "2nd", "a b", "a,b", "\xc3\xa4", "a\"b", "body", "BODY"}) {
    EXPECT_THROW(set_patches(mesh, all, {{name, 1}}), std::invalid_argument) << name;
  }
  EXPECT_THROW(set_patches(mesh, all, {{std::string(65, 'a'), 1}}), std::invalid_argument);
  EXPECT_THROW(set_patches(mesh, all, {{"a", 0}}), std::invalid_argument);
  EXPECT_THROW(set_patches(mesh, all, {{"Feet", 1}, {"feet", 2}}), std::invalid_argument);
  EXPECT_THROW(set_patches(mesh, all, {{"a", 1}, {"b", 1}}), std::invalid_argument);
  EXPECT_THROW(set_patches(mesh, all, {{"a", 1}, {"Boundary", 2}}), std::invalid_argument);
  set_patches(mesh, all, {{"Feet_1.a-b", 1}, {"b", 2}});
  EXPECT_EQ(mesh.body.number, 3);
}

TEST(FixedWidth, KeepsAsManyDigitsAsFit) {
  using Style = detail::FixedWidth::Style;
  for (const double x : {0., 1., -1., 1. / 3, -2. / 3e5, 1.2345678901234567e-300, -9.8765432109876543e+18, 1e22,
                         -123456.78901234567, 0.1, 99999999999999.9}) {
    const std::string c(detail::FixedWidth(x, 20, Style::C).text());
    const std::string nastran(detail::FixedWidth(x, 16, Style::Nastran).text());
    EXPECT_LE(c.size(), 20u) << c;
    EXPECT_LE(nastran.size(), 16u) << nastran;
    EXPECT_NEAR(std::stod(c), x, 1e-13 * std::abs(x)) << c;
    EXPECT_NEAR(std::stod(nastran), x, 1e-9 * std::abs(x)) << nastran;
    EXPECT_NE(nastran.find('.'), std::string::npos) << nastran;
  }
  EXPECT_EQ(detail::FixedWidth(0.1, 16, Style::Nastran).text(), "0.1");
  EXPECT_EQ(detail::FixedWidth(1e-5, 16, Style::Nastran).text(), "1.E-5");
  EXPECT_EQ(detail::FixedWidth(-3, 16, Style::Nastran).text(), "-3.");
}

TEST(FortranReal, HasFourteenDigitsAndAnExponentOfThree) {
  EXPECT_EQ(detail::FortranReal(0).text(), " 0.0000000000000E+000");
  EXPECT_EQ(detail::FortranReal(-0.).text(), " 0.0000000000000E+000");
  EXPECT_EQ(detail::FortranReal(1. / 3).text(), " 3.3333333333333E-001");
  EXPECT_EQ(detail::FortranReal(-2. / 3e5).text(), "-6.6666666666667E-006");
  EXPECT_EQ(detail::FortranReal(-9.99999999999999e12).text(), "-1.0000000000000E+013");
  EXPECT_EQ(detail::FortranReal(std::numeric_limits<double>::max()).text(), " 1.7976931348623E+308");
  EXPECT_EQ(detail::FortranReal(-std::numeric_limits<double>::denorm_min()).text(), "-4.9406564584125E-324");
}

TEST(RequireWidth, RefusesNumbersThatAFieldCannotHold) {
  EXPECT_NO_THROW(detail::require_width(999'999'999, 9, "an Ansys file"));
  try {
    detail::require_width(1'000'000'000, 9, "an Ansys file");
    ADD_FAILURE();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "an Ansys file with a number beyond 999999999");
  }
}

}  // namespace
}  // namespace umtet
