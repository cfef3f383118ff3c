// PLY in: encodings, headers, properties in any order, lists, and what is refused.

#include "tests/reconstruct/io/point_cloud_io_fixture.h"

namespace umtet {
namespace {

TEST_F(PointCloudIo, PlyIsReadInEveryEncodingAndDoublesStayDoubles) {
  expect_cloud("ascii.ply", ply("ascii") + text_, cloud_);
  expect_cloud("little.ply", ply("binary_little_endian") + floats_, cloud_, kFloatRounding);
  expect_cloud("big.ply", ply("binary_big_endian") + binary_rows<float>(cloud_, true), cloud_, kFloatRounding);
  expect_cloud("double.ply", ply("binary_little_endian", "double") + binary_rows<double>(cloud_), cloud_);
  expect_cloud("double_big.ply", ply("binary_big_endian", "float64") + binary_rows<double>(cloud_, true), cloud_);
}

TEST_F(PointCloudIo, PlyHeadersMayHaveCrLfAndLongComments) {
  std::string crlf;
  for (const char c : ply("binary_little_endian")) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  expect_cloud("crlf.ply", crlf + floats_, cloud_, kFloatRounding);
  const std::string comment = "comment " + std::string(200000, 'c') + "\n";
  expect_cloud("comment.ply", ply("binary_little_endian", "float", "100", comment) + floats_, cloud_, kFloatRounding);
}

TEST_F(PointCloudIo, PlyPropertiesComeInAnyOrderWithOthersAmongThem) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nobj_info made by hand\nelement camera 1\nproperty list ushort int ids\n"
      "property uchar used\nelement empty 5\nelement vertex 100\nproperty double normal_z\nproperty uchar red\n"
      "property double z\nproperty list uint8 float32 weights\nproperty double y\nproperty double normal_y\n"
      "property double normal_x\nproperty double x\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  put(bytes, std::uint16_t{3});
  for (int id = 0; id < 3; ++id) put(bytes, id);
  put(bytes, std::uint8_t{1});
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
    const Vec3 &x = cloud_.points[i], &n = cloud_.normals[i];
    put(bytes, n.z());
    put(bytes, std::uint8_t{255});
    put(bytes, x.z());
    put(bytes, static_cast<std::uint8_t>(i % 4));
    for (std::size_t w = 0; w < i % 4; ++w) put(bytes, 0.5F);
    for (const double value : {x.y(), n.y(), n.x(), x.x()}) put(bytes, value);
  }
  put(bytes, std::uint8_t{3});
  for (int id = 0; id < 3; ++id) put(bytes, id);
  expect_cloud("mixed.ply", bytes, cloud_);
}

TEST_F(PointCloudIo, AsciiPlyWithListsAndFacesIsRead) {
  std::string rows;
  std::istringstream lines(text_);
  for (std::string line; std::getline(lines, line);) rows += "2 7 8 " + line + "\r\n";
  const std::string header = replaced(ply("ascii", "float", "100", "element face 2\nproperty list uchar int v\n"),
                                      "property float x", "property list uchar int tags\nproperty float x");
  expect_cloud("faces.ply", header + rows + "3 0 1 2\n4 0 1 2 3\n", cloud_);
}

TEST_F(PointCloudIo, FaceIndicesAreNotLookedAt) {
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  for (const int index : {99999999, -7}) {
    std::string bytes = ply("binary_little_endian", "float", "100", face) + floats_;
    put(bytes, std::uint8_t{3});
    for (const int id : {0, 1, index}) put(bytes, id);
    expect_cloud("face.ply", bytes, cloud_, kFloatRounding);
  }
}

}  // namespace
}  // namespace umtet
