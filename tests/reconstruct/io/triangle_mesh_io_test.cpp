// Triangles in: STL, OBJ, OFF, PLY. What is refused is in tests/corpus.

#include "reconstruct/io/triangle_mesh_io.h"

#include <numeric>

#include "reconstruct/io/detail/triangles/polygon_soup.h"
#include "tests/reconstruct/io/point_cloud_io_fixture.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

class TriangleMeshIo : public PointCloudIo {
 protected:
  TriangleFile triangles(const std::string& name, const std::string& bytes) {
    return read_triangles(write(name, bytes));
  }

  /// The same triangles at the same places, whatever the numbers of their corners.
  void expect_mesh(const std::string& name, const std::string& bytes, const TriangleMesh& expected,
                   double tolerance = 0) {
    SCOPED_TRACE(name);
    const fs::path path = write(name, bytes);
    EXPECT_TRUE(holds_triangles(path));
    TriangleFile file;
    ASSERT_NO_THROW(file = read_triangles(path));
    ASSERT_EQ(file.mesh.F.size(), expected.F.size());
    for (std::size_t f = 0; f < expected.F.size(); ++f)
      for (int k = 0; k < 3; ++k)
        EXPECT_LE((file.mesh.corner(f, k) - expected.corner(f, k)).cwiseAbs().maxCoeff(), tolerance);
  }
};

std::string all_replaced(const std::string& text, char from, const std::string& to) {
  std::string out;
  for (const char c : text) out += c == from ? to : std::string(1, c);
  return out;
}

std::string coordinates(const Vec3& x) { return fmt::format("{} {} {}", x.x(), x.y(), x.z()); }

std::string ascii_stl(const TriangleMesh& mesh, const std::string& name = "part") {
  std::string text = "solid " + name + "\n";
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (int k = 0; k < 3; ++k) text += "   vertex " + coordinates(mesh.corner(f, k)) + "\n";
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

std::string binary_stl(const TriangleMesh& mesh, std::string header = "") {
  header.resize(80, ' ');
  put(header, static_cast<std::uint32_t>(mesh.F.size()));
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    for (int k = 0; k < 3; ++k) put(header, 0.F);
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a) put(header, static_cast<float>(mesh.corner(f, k)[a]));
    put(header, std::uint16_t{0});
  }
  return header;
}

std::string vertices(const TriangleMesh& mesh, const std::string& word) {
  std::string text;
  for (const Vec3& x : mesh.V) text += word + coordinates(x) + "\n";
  return text;
}

std::string faces(const TriangleMesh& mesh, const std::string& word, int first) {
  std::string text;
  for (const Triangle& f : mesh.F) text += fmt::format("{}{} {} {}\n", word, f[0] + first, f[1] + first, f[2] + first);
  return text;
}

const TriangleMesh kBody = test::moved(test::torus(12, 6), {.1, .2, .3});

TEST_F(TriangleMeshIo, StlIsReadInBothEncodings) {
  expect_mesh("ascii.stl", ascii_stl(kBody), kBody);
  expect_mesh("crlf.STL", all_replaced(ascii_stl(kBody), '\n', "\r\n"), kBody);
  expect_mesh("binary.stl", binary_stl(kBody), kBody, 1e-7);
  // What it begins with does not make it text.
  expect_mesh("solid.stl", binary_stl(kBody, "solid made by an exporter\n"), kBody, 1e-7);
  expect_mesh("padded.stl", binary_stl(kBody) + std::string(7, '\0'), kBody, 1e-7);
}

TEST_F(TriangleMeshIo, SolidsOfStlAreLabels) {
  const TriangleMesh other = test::moved(kBody, {5, 0, 0});
  const TriangleFile two = triangles("two.stl", ascii_stl(kBody, "left foot") + ascii_stl(other, "right"));
  EXPECT_EQ(two.report.label_names, (std::vector<std::string>{"left foot", "right"}));
  ASSERT_EQ(two.mesh.labels.size(), 2 * kBody.F.size());
  EXPECT_EQ(two.mesh.labels.front(), 1);
  EXPECT_EQ(two.mesh.labels.back(), 2);
  EXPECT_TRUE(triangles("one.stl", ascii_stl(kBody)).mesh.labels.empty());
}

TEST_F(TriangleMeshIo, ObjIsReadWithEveryKindOfIndex) {
  const std::string v = vertices(kBody, "v ");
  expect_mesh("plain.obj",
              "# made by hand\nmtllib ../../etc/passwd\n" + v + "vn 0 0 1\nvt nan\ns off\n" + faces(kBody, "f ", 1),
              kBody);
  expect_mesh("negative.obj", v + faces(kBody, "f ", -static_cast<int>(kBody.V.size())), kBody);
  std::string all, first;
  for (const Triangle& f : kBody.F) {
    all += fmt::format("f {}/7/9 {}//9 {}/7\n", f[0] + 1, f[1] + 1, f[2] + 1);
    first += fmt::format("f {} \\\n {} \\\n{}\r\n", f[0] + 1, f[1] + 1, f[2] + 1);
  }
  expect_mesh("slashes.obj", v + all, kBody);
  expect_mesh("continued.obj", first + v, kBody);  // faces may come first
  expect_mesh("coloured.obj", all_replaced(v, '\n', " 1 .5 .5\n") + faces(kBody, "f ", 1), kBody);
}

TEST_F(TriangleMeshIo, VerticesThatNoFaceUsesAreLeftOut) {
  const TriangleFile file =
      triangles("unused.obj", "v nan inf 1e300\n" + vertices(kBody, "v ") + "v 1e40 0 0\n" + faces(kBody, "f ", 2));
  EXPECT_EQ(file.mesh.V, kBody.V);
  EXPECT_EQ(file.mesh.F, kBody.F);
  EXPECT_EQ(file.report.n_vertices, kBody.V.size() + 2);
}

TEST_F(TriangleMeshIo, GroupsOfObjAreLabelsElseMaterialsElseObjects) {
  const std::string v = vertices(test::cube(), "v "), a = "f 1 2 4 3\n", b = "f 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\n",
                    c = "f 1 3 7 5\nf 2 6 8 4\n";
  const auto names = [&](const std::string& text) { return triangles("labels.obj", text).report.label_names; };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(v + "g feet left\n" + a + "usemtl steel\n" + b + "g head\n" + c), (Names{"feet left", "head"}));
  EXPECT_EQ(names("o one\n" + v + "usemtl steel\n" + a + "usemtl brass\n" + b + "o two\n" + c),
            (Names{"steel", "brass"}));
  EXPECT_EQ(names("o one\n" + v + a + b + "o two\n" + c), (Names{"one", "two"}));
  EXPECT_EQ(names("g all\n" + v + a + b + c), Names{});
  // Groups without faces are none.
  EXPECT_EQ(names("g none\n" + v + "g all\n" + a + b + c), Names{});
  const TriangleFile file = triangles("back.obj", v + "g x\n" + a + "g y\n" + b + "g x\n" + c);
  EXPECT_EQ(file.mesh.labels, (std::vector<int>{1, 1, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1}));
  std::string many = vertices(kBody, "v ");
  for (std::size_t f = 0; f < kBody.F.size(); ++f)
    many += fmt::format("g {}\nf {} {} {}\n", f, kBody.F[f][0] + 1, kBody.F[f][1] + 1, kBody.F[f][2] + 1);
  const TriangleFile ungrouped = triangles("many.obj", many);
  EXPECT_TRUE(ungrouped.mesh.labels.empty());
  EXPECT_EQ(ungrouped.report.n_groups_ignored, kBody.F.size());
}

TEST_F(TriangleMeshIo, OffIsReadWithCommentsColoursAndWithoutItsFirstWord) {
  const std::string counts = fmt::format("{} {} 0\n", kBody.V.size(), kBody.F.size());
  const std::string v = vertices(kBody, ""), f = faces(kBody, "3 ", 0);
  expect_mesh("plain.off", "OFF\n" + counts + v + f, kBody);
  expect_mesh("line.off", "OFF " + counts + "# vertices\n\n" + v + f, kBody);
  expect_mesh("bare.off", counts + v + f, kBody);
  expect_mesh("any.name",
              "COFF\n" + counts + all_replaced(v, '\n', " 255 0 0 255\n") + all_replaced(f, '\n', " 0.5 0.5 0.5\n"),
              kBody);
}

std::string ply_header(const std::string& format, const std::string& vertex, std::size_t n_vertices,
                       const std::string& face, std::size_t n_faces) {
  std::string text = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(n_vertices) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += "property " + vertex + " " + axis + "\n";
  return text + "element face " + std::to_string(n_faces) + "\n" + face + "end_header\n";
}

TEST_F(TriangleMeshIo, PlyIsReadWithItsFaces) {
  const std::string list = "property list uchar int vertex_indices\n";
  const std::string header = ply_header("ascii", "double", kBody.V.size(), list, kBody.F.size());
  expect_mesh("ascii.ply", header + vertices(kBody, "") + faces(kBody, "3 ", 0), kBody);
  for (const bool big : {false, true}) {
    std::string bytes = ply_header(
        big ? "binary_big_endian" : "binary_little_endian", "float", kBody.V.size(),
        "property uchar flags\nproperty list uint16 uint vertex_index\nproperty short label\n", kBody.F.size());
    for (const Vec3& x : kBody.V)
      for (int a = 0; a < 3; ++a) put(bytes, static_cast<float>(x[a]), big);
    for (const Triangle& f : kBody.F) {
      put(bytes, std::uint8_t{1}, big);
      put(bytes, std::uint16_t{3}, big);
      for (const int v : f) put(bytes, static_cast<std::uint32_t>(v), big);
      put(bytes, static_cast<std::int16_t>(-7), big);
    }
    expect_mesh("binary.ply", bytes, kBody, 1e-7);
    EXPECT_EQ(triangles("binary.ply", bytes).mesh.labels, std::vector<int>(kBody.F.size(), -7));
  }
}

TEST_F(TriangleMeshIo, APlyWithFewFacesIsACloud) {
  const std::string list = "property list uchar int vertex_indices\n";
  const auto file = [&](std::size_t n_faces, const std::string& property) {
    return write("some.ply", ply_header("ascii", "float", 8, property, n_faces));
  };
  EXPECT_TRUE(holds_triangles(file(12, list)));
  EXPECT_TRUE(holds_triangles(file(2, list)));
  EXPECT_FALSE(holds_triangles(file(1, list)));
  EXPECT_FALSE(holds_triangles(file(0, list)));
  EXPECT_FALSE(holds_triangles(file(12, "property int no_list\n")));
  EXPECT_FALSE(holds_triangles(file(12, list), PlyFaces::Ignored));
  EXPECT_FALSE(holds_triangles(write("cloud.ply", ply("ascii") + text_)));
  EXPECT_FALSE(holds_triangles(write("cloud.xyz", text_)));
  EXPECT_TRUE(holds_triangles(write("cloud.obj", text_)));
}

TEST_F(TriangleMeshIo, WrittenTrianglesAreReadBackBitByBit) {
  TriangleMesh mesh = kBody;
  for (const bool labelled : {false, true}) {
    if (labelled) mesh.labels.resize(mesh.F.size(), 3);
    std::ostringstream out;
    write_ply(out, mesh);
    const TriangleMesh read = triangles("written.ply", out.str()).mesh;
    EXPECT_EQ(read.V, mesh.V);
    EXPECT_EQ(read.F, mesh.F);
    EXPECT_EQ(read.labels, mesh.labels);
  }
}

double area_of(const std::vector<Vec3>& polygon, const std::array<int, 3>& t) {
  return (polygon[t[1]] - polygon[t[0]]).cross(polygon[t[2]] - polygon[t[0]]).norm() / 2;
}

TEST(CutPolygon, TrianglesOfConcavePolygonsLieInThem) {
  // A comb: its fans from any corner leave it.
  std::vector<Vec3> comb;
  for (int tooth = 0; tooth < 5; ++tooth) {
    comb.emplace_back(2 * tooth, 3, 1);
    comb.emplace_back(2 * tooth + 1, .1, 1);
  }
  comb.emplace_back(10, 3, 1);
  comb.emplace_back(10, 0, 1);
  comb.emplace_back(0, 0, 1);
  double shoelace = 0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const Vec3 &a = comb[i], &b = comb[(i + 1) % comb.size()];
    shoelace += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  for (std::size_t shift = 0; shift < comb.size(); ++shift) {
    std::rotate(comb.begin(), comb.begin() + 1, comb.end());
    const auto triangles = detail::cut_polygon(comb);
    EXPECT_EQ(triangles.size(), comb.size() - 2);
    double area = 0;
    for (const auto& t : triangles) area += area_of(comb, t);
    EXPECT_NEAR(area, std::abs(shoelace), 1e-9);  // they neither overlap nor leave it
  }
}

TEST(CutPolygon, WhatIsNoSimplePolygonIsStillCut) {
  const std::vector<Vec3> line(5, Vec3(1, 2, 3));
  EXPECT_EQ(detail::cut_polygon(line).size(), 3U);
  const std::vector<Vec3> bow = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(detail::cut_polygon(bow).size(), 2U);
}

}  // namespace
}  // namespace umtet
