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

TEST_F(PointCloudIo, MalformedPlyIsRefusedWithTheReason) {
  const std::string little = ply("binary_little_endian") + floats_, ascii = ply("ascii") + text_;
  expect_refused("header_cut.ply", little.substr(0, 40), {"line 3", "'elem'"});
  expect_refused("header_end_cut.ply", little.substr(0, little.find("end_header")), {"end_header", "cut short"});
  expect_refused("body_cut.ply", little.substr(0, 1000), {"100", "bytes are left", "cut short"});
  expect_refused("ascii_cut.ply", ascii.substr(0, 6000), {"line ", "cut short"});
  for (const char* count : {"4000000000", "1000000000000000000"})
    expect_refused("count.ply", ply("binary_little_endian", "float", count) + floats_, {count, "2400 bytes are left"});
  for (const char* count : {"4000000000", "1000000000000000000"})
    expect_refused("count_ascii.ply", ply("ascii", "float", count) + text_, {count, "line 11"});
  for (const char* count : {"-5", "abc", "99999999999999999999"})
    expect_refused("count.ply", ply("binary_little_endian", "float", count) + floats_, {"line 3", count});
  expect_refused("few_announced.ply", ply("binary_little_endian", "float", "50") + floats_, {"after the last item"});
  expect_refused("nan.ply", with_line(ascii, 10 + 41, "nan inf -inf nan nan nan"), {"point 42 ", "1 such"});
  expect_refused("no_vertices.ply", ply("binary_little_endian", "float", "0"), {"0 points"});
  expect_refused("empty.ply", "", {"empty"});
  expect_refused("no_end.ply", replaced(little, "end_header\n", ""), {"line 10"});
  expect_refused("no_normals.ply",
                 replaced(replaced(replaced(little, "property float nx\n", ""), "property float ny\n", ""),
                          "property float nz\n", ""),
                 {"no normals", "nx, ny, nz", "CloudCompare"});
  expect_refused("float128.ply", ply("binary_little_endian", "float128") + floats_, {"line 4", "float128"});
  expect_refused("two_vertex.ply", ply("binary_little_endian", "float", "100", "element vertex 100\n") + floats_,
                 {"line 10"});
  std::string commas = text_;
  std::replace(commas.begin(), commas.end(), '.', ',');
  expect_refused("commas.ply", ply("ascii") + commas, {"line 11", "decimal comma"});
  expect_refused("random.ply", random_bytes(5000), {"line 1"});
  expect_refused("random_body.ply", ply("ascii") + random_bytes(5000), {"line 11"});
  expect_refused("no_y.ply", replaced(little, "property float y\n", ""), {"no property y"});
  expect_refused("two_x.ply", replaced(little, "property float y\n", "property float x\n"),
                 {"property x more than once"});
  std::string elements;
  for (int i = 0; i < 200; ++i) elements += "element e" + std::to_string(i) + " 0\n";
  expect_refused("elements.ply", ply("ascii", "float", "100", elements) + text_, {"too many"});
  expect_refused("no_format.ply", replaced(little, "format binary_little_endian 1.0\n", ""), {"no format"});
  expect_refused("long_row.ply", with_line(ascii, 12, "1 2 3 4 5 6 7"), {"line 13", "too many"});
}

TEST_F(PointCloudIo, PlyListsLongerThanTheFileAreRefused) {
  std::string bytes =
      ply("binary_little_endian", "float", "100", "element face 1\nproperty list uchar int v\n") + floats_;
  put(bytes, std::uint8_t{255});
  for (int id = 0; id < 3; ++id) put(bytes, id);
  expect_refused("list.ply", bytes, {"face 1 of 1"});
  bytes = ply("binary_little_endian", "float", "100", "element face 1\nproperty list uint int v\n") + floats_;
  put(bytes, std::uint32_t{0xfffffff0});
  for (int id = 0; id < 3; ++id) put(bytes, id);
  expect_refused("list_uint.ply", bytes, {"face 1 of 1"});
  bytes = ply("binary_little_endian", "float", "100", "element face 1\nproperty list char int v\n") + floats_;
  put(bytes, std::int8_t{-1});
  expect_refused("list_negative.ply", bytes, {"negative"});
  expect_refused("list_ascii.ply",
                 ply("ascii", "float", "100", "element face 1\nproperty list uchar int v\n") + text_ + "255 0 1 2\n",
                 {"line 113", "list length"});
}

}  // namespace
}  // namespace umtet
