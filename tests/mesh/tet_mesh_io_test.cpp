#include "mesh/tet_mesh_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <system_error>

#include "mesh/quadratic_tets.h"
#include "mesh/skin.h"
#include "mesh/solver_files.h"
#include "tests/support/domains.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/shell.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

fs::path scratch(const std::string& name) {
  return fs::path(::testing::TempDir()) / ("umtet_io_" + std::to_string(::getpid()) + "_" + name);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

fs::path with_bytes(const std::string& name, const std::string& bytes) {
  const fs::path path = scratch(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

bool bit_equal(const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3)) == 0;
}

struct Shape {
  TetMesh mesh;
  std::vector<Triangle> boundary;
};

/// Coordinates with all their bits in use, and one mixed with tiny and huge values.
Shape sample(int n = 3) {
  Shape s;
  s.mesh = testing::cubes(n, [](int, int, int) { return true; });
  testing::perturb(s.mesh, 0.1, 5);
  s.mesh.V[0] *= 1e-30;
  s.mesh.V[1].x() += 1e9;
  s.mesh.V[2].y() = -0.0;
  s.boundary = boundary_faces(s.mesh.C, s.mesh.V.size()).triangles;
  return s;
}

struct Format {
  std::string name;
  std::function<void(const fs::path&, const Shape&)> write;
};

std::vector<Format> formats() {
  return {
      {"a.vtu", [](const fs::path& p, const Shape& s) { write_vtu(p, with_standard_data(s.mesh, {}, {})); }},
      {"a22.msh", [](const fs::path& p, const Shape& s) { write_msh22(p, solver_mesh(s.mesh), MshEncoding::Ascii); }},
      {"b22.msh", [](const fs::path& p, const Shape& s) { write_msh22(p, solver_mesh(s.mesh), MshEncoding::Binary); }},
      {"a41.msh", [](const fs::path& p, const Shape& s) { write_msh41(p, solver_mesh(s.mesh), MshEncoding::Ascii); }},
      {"b41.msh", [](const fs::path& p, const Shape& s) { write_msh41(p, solver_mesh(s.mesh), MshEncoding::Binary); }},
      {"a.mesh", [](const fs::path& p, const Shape& s) { write_medit(p, solver_mesh(s.mesh)); }}};
}

TEST(TetMeshIo, EveryFormatReadsBackBitEqual) {
  const Shape shape = sample();
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    const MeshFile file = read_tet_mesh(path);
    EXPECT_TRUE(bit_equal(file.mesh.V, shape.mesh.V)) << format.name;
    EXPECT_EQ(file.mesh.C, shape.mesh.C) << format.name;
    EXPECT_EQ(file.n_unused_vertices, 0u);
    fs::remove(path);
  }
}

TEST(TetMeshIo, VtuCarriesTheStandardData) {
  const Shape shape = sample();
  std::vector<std::int64_t> background_vertex(shape.mesh.V.size()), background_tet(shape.mesh.C.size());
  for (std::size_t i = 0; i < background_vertex.size(); ++i) background_vertex[i] = (std::int64_t{1} << 60) + 7 * i + 1;
  for (std::size_t t = 0; t < background_tet.size(); ++t) background_tet[t] = 46 * t + 3;
  const fs::path path = scratch("data.vtu");
  const MeshFile written = with_standard_data(shape.mesh, background_vertex, background_tet);
  write_vtu(path, written);
  const MeshFile read = read_tet_mesh(path);
  EXPECT_EQ(read.point_data, written.point_data);
  EXPECT_EQ(read.cell_data, written.cell_data);
  EXPECT_EQ(read.point_data.size(), 2u);
  EXPECT_EQ(read.cell_data.size(), 2u);
  const auto& boundary = std::get<std::vector<std::uint8_t>>(read.point_data.at("boundary"));
  EXPECT_EQ(std::count(boundary.begin(), boundary.end(), 0), 8) << "a block of 3 cubes has 2^3 inner vertices";
  const std::string first = bytes_of(path);
  write_vtu(path, written);
  EXPECT_EQ(bytes_of(path), first) << "the same mesh gives the same bytes";
  EXPECT_NE(first.find("header_type=\"UInt64\""), std::string::npos);
  EXPECT_EQ(first.find("compressor"), std::string::npos);
  EXPECT_THROW(write_vtu(path, {shape.mesh, {{"short", std::vector<double>(3)}}, {}, 0}), std::invalid_argument);
  fs::remove(path);
}

TEST(TetMeshIo, OtherElementsUnusedVerticesAndMiddleNodesAreLeftOut) {
  const std::string msh22 =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\n$Nodes is not here\n$EndComments\n$Nodes\n6\n"
      "10 0 0 0\n2 9 9 9\n30 1 0 0\n40 0 1 0\n50 0 0 1\n60 .5 .5 .5\n$EndNodes\n"
      "$Elements\n3\n1 15 2 0 0 2\n2 2 2 0 0 10 30 40\n3 4 2 0 0 10 30 40 50\n$EndElements\n";
  const MeshFile gmsh = read_tet_mesh(with_bytes("other.msh", msh22));
  EXPECT_EQ(gmsh.mesh.C, (std::vector<Tet>{{0, 1, 2, 3}}));
  EXPECT_EQ(gmsh.mesh.V[3], Vec3(0, 0, 1));
  EXPECT_EQ(gmsh.n_unused_vertices, 2u);

  const std::string quadratic =
      "MeshVersionFormatted 1\nDimension\n3\n# corners, then middles\nVertices\n10\n0 0 0 0\n2 0 0 0\n0 2 0 0\n0 0 2 "
      "0\n"
      "1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n0 1 1 0\nRequiredVertices\n1\n1\nTetrahedraP2\n1\n"
      "1 2 3 4 5 6 7 8 9 10 0\nEnd\n";
  const MeshFile medit = read_tet_mesh(with_bytes("p2.mesh", quadratic));
  EXPECT_EQ(medit.mesh.V.size(), 4u);
  EXPECT_EQ(medit.n_unused_vertices, 0u);

  const std::string vtu =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">"
      "<UnstructuredGrid><Piece NumberOfPoints=\"11\" NumberOfCells=\"2\"><PointData><DataArray type=\"Int32\" "
      "Name=\"id\" "
      "format=\"ascii\">0 1 2 3 4 5 6 7 8 9 10</DataArray></PointData><CellData><DataArray type=\"Float32\" Name=\"q\" "
      "format=\"ascii\">7 8</DataArray></CellData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" "
      "format=\"ascii\">9 9 9 0 0 0 2 0 0 0 2 0 0 0 2 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 0 1 1</DataArray></Points><Cells>"
      "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 1 2 3 4 5 6 7 8 9 10</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 13</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 "
      "24</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  const MeshFile vtk = read_tet_mesh(with_bytes("quadratic.vtu", vtu));
  EXPECT_EQ(vtk.mesh.C, (std::vector<Tet>{{0, 1, 2, 3}}));
  EXPECT_EQ(vtk.mesh.V[0], Vec3(0, 0, 0));
  EXPECT_EQ(std::get<std::vector<std::int64_t>>(vtk.point_data.at("id")), (std::vector<std::int64_t>{1, 2, 3, 4}));
  EXPECT_EQ(std::get<std::vector<double>>(vtk.cell_data.at("q")), std::vector<double>{8});
  for (const char* name : {"other.msh", "p2.mesh", "quadratic.vtu"}) fs::remove(scratch(name));
}

/// The reason a file is refused for, or what went wrong.
std::string refusal(const fs::path& path) {
  try {
    read_tet_mesh(path);
    return "accepted";
  } catch (const MeshFileRefused& e) {
    return e.what();
  }
}

/// One tet of second order whose mid-sides say between which corners they are, and a vertex in no tet before it.
const std::array<Vec3, 10> kTenNodes = {
    {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};

TEST(TetMeshIo, TetsOfTenNodesAreReadInTheOrderOfVtk) {
  const std::string msh22 =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n1 9 9 9\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n"
      "7 0 1 1\n8 0 0 0\n9 2 0 0\n10 0 2 0\n11 0 0 2\n$EndNodes\n"
      "$Elements\n1\n1 11 2 0 0 8 9 10 11 2 3 4 5 7 6\n$EndElements\n";
  const std::string msh41 =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 11 1 11\n3 1 0 11\n1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n"
      "9 9 9\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n0 1 1\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n$EndNodes\n"
      "$Elements\n1 1 1 1\n3 1 11 1\n1 8 9 10 11 2 3 4 5 7 6\n$EndElements\n";
  const std::string medit =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n11\n9 9 9 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n"
      "0 1 1 0\n0 0 0 0\n2 0 0 0\n0 2 0 0\n0 0 2 0\nTetrahedraP2\n1\n8 9 10 11 2 3 4 5 6 7 0\nEnd\n";
  for (const auto& [name, bytes] :
       {std::pair{"q22.msh", msh22}, std::pair{"q41.msh", msh41}, std::pair{"q.mesh", medit}}) {
    SCOPED_TRACE(name);
    const MeshFile file = read_tet_mesh(with_bytes(name, bytes));
    ASSERT_TRUE(file.quadratic);
    EXPECT_EQ(file.mesh.V.size(), 4u);
    EXPECT_EQ(file.n_unused_vertices, 1u);
    for (int n = 0; n < 10; ++n) EXPECT_EQ(file.quadratic->V[file.quadratic->C.at(0)[n]], kTenNodes[n]) << n;
    fs::remove(scratch(name));
  }
}

TEST(TetMeshIo, MeshesOfSecondOrderReadBackBitEqual) {
  const Shape shape = sample();
  QuadraticTetMesh mesh = quadratic_tets(shape.mesh, {}, testing::sphere(), 1).mesh;
  std::vector<double> id(mesh.V.size()), of_tets(mesh.C.size(), 3.);
  std::iota(id.begin(), id.end(), 0.);
  const fs::path path = scratch("second.vtu");
  write_vtu(path, mesh, {{"id", id}}, {{"three", of_tets}});
  const MeshFile file = read_tet_mesh(path);
  EXPECT_TRUE(bit_equal(file.mesh.V, shape.mesh.V));
  EXPECT_EQ(file.mesh.C, shape.mesh.C);
  ASSERT_TRUE(file.quadratic);
  EXPECT_TRUE(bit_equal(file.quadratic->V, mesh.V));
  EXPECT_EQ(file.quadratic->C, mesh.C);
  EXPECT_EQ(file.n_unused_vertices, 0u);
  id.resize(shape.mesh.V.size());
  EXPECT_EQ(std::get<std::vector<double>>(file.point_data.at("id")), id);
  EXPECT_EQ(std::get<std::vector<double>>(file.cell_data.at("three")), of_tets);

  mesh.C[1][4] = mesh.C[0][0];  // no mid-side, but a corner
  write_vtu(path, mesh, {}, {});
  EXPECT_NE(refusal(path).find("node 0: it is a mid-side of one tet and a corner of another"), std::string::npos)
      << refusal(path);
  mesh.C[1][4] = mesh.C[0][4];
  mesh.V[mesh.C[0][4]].y() = std::nan("");
  write_vtu(path, mesh, {}, {});
  EXPECT_NE(refusal(path).find("not a finite number"), std::string::npos) << refusal(path);
  EXPECT_THROW(write_vtu(path, mesh, {{"id", id}}, {}), std::invalid_argument);
  fs::remove(path);
}

// As ParaView writes them. VTK divides by the size of a part before it is compressed.
TEST(TetMeshIo, AppendedBlocksAreReadAndTheirHeadersChecked) {
  const fs::path seeds = fs::path(UMTET_SOURCE_DIR) / "tests/fuzz/seeds/mesh_vtu";
  for (const char* name : {"appended_raw.vtu", "appended_base64.vtu"}) {
    const MeshFile file = read_tet_mesh(seeds / name);
    EXPECT_EQ(file.mesh.C, std::vector<Tet>({{0, 1, 2, 3}})) << name;
    EXPECT_EQ(file.mesh.V.at(3), Vec3(0, 0, 1)) << name;
  }
  for (const char* name :
       {"appended_no_bytes.vtu", "parts_of_no_bytes.vtu", "no_parts_of_no_bytes.vtu", "offset_without_format.vtu"}) {
    const std::string message = refusal(seeds / name);
    EXPECT_NE(message.find("parts of 0 bytes"), std::string::npos) << message;
  }
  const std::string beyond = refusal(seeds / "last_offset.vtu");
  EXPECT_NE(beyond.find("more than the file can hold"), std::string::npos) << beyond;
  const std::string damaged = refusal(seeds / "damaged_cell_data.vtu");  // and has no point data
  EXPECT_NE(damaged.find("VTK cannot read it"), std::string::npos) << damaged;
  const std::string text = bytes_of(seeds / "appended_raw.vtu");
  // What the parser behind VTK sees otherwise than a search for letters would.
  const std::vector<std::array<std::string, 3>> hidden = {
      {"offset=\"96\"", "Note=\"a offset='96'\" offset=\"97\"", "more parts than bytes"},
      {"offset=\"96\"", "offset=\"&#57;7\"", "references to characters"},
      {"<Cells>", "<Cells a=\"b>\">", "attributes"},
      {"<Cells>", "<!-- <AppendedData encoding=\"raw\"> --><Cells>", "in a comment"},
      {"<Cells>", "<?x ><AppendedData>_?><Cells>", "in a comment"}};
  for (const auto& [from, to, reason] : hidden) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const fs::path file = with_bytes("hidden.vtu", changed);
    EXPECT_NE(refusal(file).find(reason), std::string::npos) << to << ": " << refusal(file);
    fs::remove(file);
  }
  // VTK would count offsets from the first byte behind the tag, find other headers there, and believe them: 8 GB.
  const std::string message = refusal(seeds / "appended_beside_underscore.vtu");
  EXPECT_NE(message.find("appended data without a beginning"), std::string::npos) << message;
}

TEST(TetMeshIo, LyingFilesAreRefusedWithPathPlaceAndReason) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const std::string vtu =
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4000000000\" NumberOfCells=\"1\">"
      "</Piece></UnstructuredGrid></VTKFile>";
  const std::vector<std::array<std::string, 3>> cases = {
      {"empty.msh", "", "no $MeshFormat"},
      {"empty.mesh", "", "empty"},
      {"empty.vtu", "", "not a VTK XML file"},
      {"huge.msh", head + "$Nodes\n4000000000\n", "more than the file can hold"},
      {"negative.msh", head + "$Nodes\n-5\n", "not a number"},
      {"word.msh", head + "$Nodes\n1\n1 0 zero 0\n", "line 6"},
      {"version.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n", "only 2.2 and 4.1"},
      {"missing.msh", head + "$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 2 0 0 1 2 3 4\n$EndElements\n",
       "node 2 does not exist"},
      {"twice.msh", head + "$Nodes\n2\n1 0 0 0\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 2 0 0 1 1 1 1\n$EndElements\n",
       "given twice"},
      {"huge.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n123456789012\n", "more than the file can hold"},
      {"flat.mesh", "MeshVersionFormatted 2\nDimension 2\n", "must be 3"},
      {"none.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nEnd\n", "no tets"},
      {"huge.vtu", vtu, "more than the file can hold"},
      {"nest.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid></VTKFile>", "do not nest"},
      {"other.vtu", "<VTKFile type=\"PolyData\"></VTKFile>", "UnstructuredGrid"},
      {"what.stl", "solid", "unknown extension"}};
  for (const auto& [name, bytes, reason] : cases) {
    const fs::path path = with_bytes(name, bytes);
    const std::string message = refusal(path);
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_NE(message.find(path.string()), std::string::npos) << message;
    fs::remove(path);
  }
  EXPECT_THROW(read_tet_mesh("/nowhere/a.msh"), std::system_error);
  EXPECT_THROW(read_tet_mesh("/nowhere/a.vtu"), std::system_error);
}

TEST(TetMeshIo, ACutFileIsRefusedAndADamagedOneNeverCrashes) {
  const Shape shape = sample(1);
  std::mt19937 random(11);
  ::testing::internal::CaptureStderr();
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    const std::string whole = bytes_of(path);
    for (int cut = 0; cut < 24; ++cut) {
      // A MEDIT file that lacks only the closing keyword is complete.
      std::ofstream(path, std::ios::binary) << whole.substr(0, (whole.size() - 8) * cut / 24);
      EXPECT_NE(refusal(path), "accepted") << format.name << " cut " << cut;
    }
    for (int trial = 0; trial < 60; ++trial) {
      std::string damaged = whole;
      for (int hit = 0; hit < 3; ++hit) damaged[random() % damaged.size()] = static_cast<char>(random());
      std::ofstream(path, std::ios::binary) << damaged;
      refusal(path);  // read or refused; anything else would escape or end the program
    }
    fs::remove(path);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library does not print";
}

TEST(TetMeshIo, AFullDiskIsAnErrorThatNamesThePath) {
  const Shape shape = sample();
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    // Also one byte short: what is lost then is lost at the close.
    for (const std::uintmax_t limit : {std::uintmax_t{1000}, fs::file_size(path) - 1}) {
      std::string message;
      {
        const test::FileSizeLimit full(limit);
        try {
          format.write(path, shape);
        } catch (const std::runtime_error& e) {
          message = e.what();
        }
      }
      EXPECT_NE(message.find(path.string()), std::string::npos) << format.name << ": '" << message << "'";
    }
    fs::remove(path);
  }
  EXPECT_THROW(write_vtu("/nowhere/a.vtu", {shape.mesh, {}, {}, 0}), std::runtime_error);
}

TEST(TetMeshIo, GmshReadsOurFiles) {
  if (!test::succeeds("gmsh --version")) GTEST_SKIP() << "gmsh is not installed";
  const Shape shape = sample();
  for (const Format& format : formats()) {
    if (format.name.ends_with(".vtu")) continue;  // the gmsh of Debian 12 writes VTK files of its own kind only
    const fs::path path = scratch(format.name), again = scratch("again.msh");
    format.write(path, shape);
    const std::string out =
        test::shell("gmsh " + path.string() + " -save -save_all -format msh22 -o " + again.string());
    EXPECT_NE(out.find(std::to_string(shape.mesh.V.size()) + " nodes"), std::string::npos) << out;
    EXPECT_EQ(out.find("Error"), std::string::npos) << out;
    EXPECT_EQ(out.find("Warning"), std::string::npos) << out;
    EXPECT_EQ(read_tet_mesh(again).mesh.C.size(), shape.mesh.C.size()) << format.name;
    const std::string text = bytes_of(again);
    if (format.name.ends_with(".msh")) {
      EXPECT_NE(text.find("2 2 \"boundary\""), std::string::npos) << format.name;
      EXPECT_NE(text.find("3 1 \"body\""), std::string::npos) << format.name;
    }
    fs::remove(path);
    fs::remove(again);
  }
}

TEST(TetMeshIo, MeshioReadsOurFiles) {
  const std::string python = test::kPython;
  if (!test::succeeds(python + " -c 'import meshio'")) GTEST_SKIP() << "meshio is not installed";
  const Shape shape = sample();
  const fs::path script = with_bytes("read.py",
                                     "import sys, meshio\n"
                                     "for path in sys.argv[1:]:\n"
                                     "    m = meshio.read(path)\n"
                                     "    n = {}\n"
                                     "    for c in m.cells: n[c.type] = n.get(c.type, 0) + len(c.data)\n"
                                     "    g = sorted((k, *map(int, v)) for k, v in m.field_data.items())\n"
                                     "    print('read', len(m.points), n.get('tetra'), n.get('triangle', 0), g)\n");
  std::string command = python + " " + script.string(), expected;
  const std::string counts =
      "read " + std::to_string(shape.mesh.V.size()) + " " + std::to_string(shape.mesh.C.size()) + " ";
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    command.append(" ").append(path.string());
    expected += counts + std::to_string(format.name == "a.vtu" ? 0 : shape.boundary.size()) +
                (format.name.ends_with(".msh") ? " [('body', 1, 3), ('boundary', 2, 2)]\n" : " []\n");
  }
  std::string out = test::shell(command);
  for (auto at = out.find("\n\n"); at != std::string::npos; at = out.find("\n\n"))
    out.erase(at, 1);  // meshio prints those
  EXPECT_NE(out.find(expected), std::string::npos) << out << "expected\n" << expected;
  for (const Format& format : formats()) fs::remove(scratch(format.name));
  fs::remove(script);
}

TEST(ReadTetMesh, ATetWithANodeTwiceAndANodeWithoutAPlaceAreNamed) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("umtet_broken_" + std::to_string(::getpid()) + ".mesh");
  const auto refusal = [&](const std::string& third, const std::string& tet) {
    std::ofstream(file) << "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n9 9 nan 0\n0 0 0 0\n1 0 0 0\n"
                        << third << " 0\n0 0 1 0\nTetrahedra\n1\n"
                        << tet << " 1\nEnd\n";
    try {
      read_tet_mesh(file);
    } catch (const MeshFileRefused& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal("0 1 0", "2 3 4 5"), "accepted");  // node 1 is no number, but in no tet
  EXPECT_NE(refusal("0 1 0", "2 3 4 4").find("tet 1: it has its node 4 twice"), std::string::npos);
  EXPECT_NE(refusal("0 inf 0", "2 3 4 5").find("node 4: a coordinate is not"), std::string::npos);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace umtet
