// PCD in: encodings, fields in any order, and what is refused.

#include "tests/reconstruct/io/point_cloud_io_fixture.h"

namespace umtet {
namespace {

TEST_F(PointCloudIo, PcdIsReadInEveryEncodingAndDoublesStayDoubles) {
  expect_cloud("ascii.pcd", pcd("ascii") + text_, cloud_);
  expect_cloud("binary.pcd", pcd("binary") + floats_, cloud_, kFloatRounding);
  expect_cloud("double.pcd", pcd("binary", "8") + binary_rows<double>(cloud_), cloud_);
  const std::string floats = by_fields<float>(cloud_), packed = lzf_literals(floats);
  expect_cloud("packed.pcd",
               pcd("binary_compressed") + compressed_block(static_cast<std::uint32_t>(packed.size()),
                                                           static_cast<std::uint32_t>(floats.size()), packed),
               cloud_, kFloatRounding);
  const std::string doubles = by_fields<double>(cloud_), packed_doubles = lzf_literals(doubles);
  expect_cloud(
      "packed_double.pcd",
      pcd("binary_compressed", "8") + compressed_block(static_cast<std::uint32_t>(packed_doubles.size()),
                                                       static_cast<std::uint32_t>(doubles.size()), packed_doubles),
      cloud_);
}

TEST_F(PointCloudIo, PcdTellsWhereTheScannerStood) {
  const std::string header = pcd("ascii"), unknown = "VIEWPOINT 0 0 0 1 0 0 0";
  const auto viewpoint = [&](const std::string& line) {
    std::string bytes = header + text_;
    bytes.replace(bytes.find(unknown), unknown.size(), line);
    return read("viewpoint.pcd", bytes).report.viewpoint;
  };
  EXPECT_FALSE(viewpoint(unknown));
  EXPECT_EQ(viewpoint("VIEWPOINT 1 -2.5 3e2 1 0 0 0"), Vec3(1, -2.5, 300));
  EXPECT_EQ(viewpoint("VIEWPOINT 0 0 0 0 1 0 0"), Vec3(0, 0, 0));  // turned, so somebody wrote it
  for (const char* nothing : {"VIEWPOINT", "VIEWPOINT 1 2 3", "VIEWPOINT 1 2 x 1 0 0 0", "VIEWPOINT nan 0 0 1 0 0 0"})
    EXPECT_FALSE(viewpoint(nothing)) << nothing;
}

TEST_F(PointCloudIo, PcdFieldsComeInAnyOrderWithOthersAmongThem) {
  std::string bytes =
      "VERSION .7\nFIELDS normal_z _ x y histogram z normal_x normal_y label\nSIZE 8 1 8 8 2 8 8 8 8\n"
      "TYPE F U F F U F F F U\nCOUNT 1 3 1 1 2 1 1 1 1\nWIDTH 50\nHEIGHT 2\nPOINTS 100\nDATA binary\n";
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
    const Vec3 &x = cloud_.points[i], &n = cloud_.normals[i];
    put(bytes, n.z());
    bytes.append(3, '\x7f');
    for (const double value : {x.x(), x.y()}) put(bytes, value);
    put(bytes, std::uint32_t{0xffffffff});
    for (const double value : {x.z(), n.x(), n.y()}) put(bytes, value);
    put(bytes, std::uint64_t{i});
  }
  expect_cloud("fields.pcd", bytes, cloud_);
}

}  // namespace
}  // namespace umtet
