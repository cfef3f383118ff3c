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

TEST_F(PointCloudIo, MalformedPcdIsRefusedWithTheReason) {
  expect_refused("binary_cut.pcd", (pcd("binary") + floats_).substr(0, 1000), {"100 points", "cut short"});
  expect_refused("points.pcd", pcd("binary", "4", "1", "4000000000", "4000000000") + floats_, {"4000000000 points"});
  expect_refused("points_ascii.pcd", pcd("ascii", "4", "1", "4000000000", "4000000000") + text_, {"100 of 4000000000"});
  expect_refused("points_64.pcd", pcd("binary", "4", "1", "1", "1000000000000000000") + floats_, {"POINTS"});
  expect_refused("width.pcd", pcd("binary", "4", "1", "90") + floats_, {"POINTS 100", "WIDTH 90"});
  expect_refused("count_negative.pcd", pcd("binary", "4", "-1") + floats_, {"COUNT", "-1"});
  expect_refused("count_large.pcd", pcd("binary", "4", "2000000000") + floats_, {"COUNT 2000000000"});
  expect_refused("size_zero.pcd", pcd("binary", "0") + floats_, {"SIZE", "'0'"});
  expect_refused("type.pcd", replaced(pcd("binary"), "TYPE F", "TYPE Q") + floats_, {"'Q'"});
  const std::string floats = by_fields<float>(cloud_), packed = lzf_literals(floats);
  const auto n_packed = static_cast<std::uint32_t>(packed.size()), n_floats = static_cast<std::uint32_t>(floats.size());
  const std::string header = pcd("binary_compressed");
  expect_refused("lying.pcd", header + compressed_block(0xfffffff0, 0xfffffff0, packed), {"are left"});
  expect_refused("unpacked.pcd", header + compressed_block(n_packed, 0xfffffff0, packed), {"4294967280"});
  expect_refused("packed_cut.pcd", header + compressed_block(n_packed, n_floats, packed.substr(0, 700)), {"are left"});
  expect_refused("wrong_size.pcd", header + compressed_block(n_packed, n_floats - 24, packed), {"damaged"});
  expect_refused("damaged.pcd", header + compressed_block(n_packed, n_floats, random_bytes(static_cast<int>(n_packed))),
                 {"cannot be unpacked"});
  expect_refused("bomb.pcd",
                 pcd("binary_compressed", "4", "1", "80000000", "80000000") + compressed_block(4, 1920000000, "aaaa"),
                 {"1920000000"});
  expect_refused("no_block.pcd", header + "abc", {"no compressed block"});
  const std::string ascii = pcd("ascii") + text_;
  expect_refused("ascii_cut.pcd", ascii.substr(0, ascii.size() / 2), {"line ", "cut short"});
  expect_refused("empty.pcd", "", {"empty"});
  expect_refused("no_points.pcd", pcd("binary", "4", "1", "0", "0"), {"0 points"});
  expect_refused("no_points_packed.pcd", pcd("binary_compressed", "4", "1", "0", "0") + compressed_block(0, 0, ""),
                 {"0 points"});
  expect_refused("no_fields.pcd", replaced(pcd("binary"), "FIELDS x y z normal_x normal_y normal_z\n", "") + floats_,
                 {"FIELDS"});
  expect_refused("only_padding.pcd",
                 "FIELDS _\nSIZE 4\nTYPE F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary_compressed\n12345678",
                 {"no fields"});
  expect_refused("bare_data.pcd", "VERSION .7\nDATA\n", {"FIELDS"});
  expect_refused("no_normals.pcd", replaced(pcd("binary"), "normal_x normal_y normal_z", "a b c") + floats_,
                 {"no normals"});
  expect_refused("random.pcd", random_bytes(5000), {"line 1"});
}

}  // namespace
}  // namespace umtet
