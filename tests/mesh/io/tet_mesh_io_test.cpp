#include "mesh/io/tet_mesh_io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

#include "mesh/second_order/quadratic_tets.h"
#include "tests/support/domains.h"
#include "tests/support/mesh_files.h"

namespace umtet {
namespace {

using namespace test;

bool bit_equal(const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3)) == 0;
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
  write_vtu(path, mesh, {{"id", id}, {"place", mesh.V}}, {{"three", of_tets}});
  const MeshFile file = read_tet_mesh(path);
  EXPECT_TRUE(bit_equal(file.mesh.V, shape.mesh.V));
  EXPECT_EQ(file.mesh.C, shape.mesh.C);
  ASSERT_TRUE(file.quadratic);
  EXPECT_TRUE(bit_equal(file.quadratic->V, mesh.V));
  EXPECT_EQ(file.quadratic->C, mesh.C);
  EXPECT_EQ(file.n_unused_vertices, 0u);
  EXPECT_EQ(std::get<std::vector<double>>(file.quadratic_data.at("id")), id);
  EXPECT_TRUE(bit_equal(std::get<std::vector<Vec3>>(file.quadratic_data.at("place")), mesh.V));
  EXPECT_TRUE(bit_equal(std::get<std::vector<Vec3>>(file.point_data.at("place")), shape.mesh.V));
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

}  // namespace
}  // namespace umtet
