#include "reconstruct/point_cloud_io.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "tests/reconstruct/cloud_corpus.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

class PointCloudIo : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("umtet_" + std::to_string(getpid()) + test->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  CloudFile read(const std::string& name, const std::string& bytes) { return read_point_cloud(write(name, bytes)); }

  /// Largest coordinate difference allowed: 0 where doubles were stored, rounding to float otherwise.
  void expect_cloud(const std::string& name, const std::string& bytes, const OrientedPointCloud& expected,
                    double tolerance = 0) {
    SCOPED_TRACE(name);
    CloudFile file;
    ASSERT_NO_THROW(file = read(name, bytes));
    ASSERT_EQ(file.cloud.points.size(), expected.points.size());
    ASSERT_EQ(file.cloud.normals.size(), expected.points.size());
    EXPECT_EQ(file.report.n_points, expected.points.size());
    for (std::size_t i = 0; i < expected.points.size(); ++i) {
      EXPECT_LE((file.cloud.points[i] - expected.points[i]).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LE((file.cloud.normals[i] - expected.normals[i]).cwiseAbs().maxCoeff(), tolerance);
    }
  }

  /// Refused, in one line that names the file and has each of `words`.
  void expect_refused(const std::string& name, const std::string& bytes, const std::vector<std::string>& words) {
    SCOPED_TRACE(name);
    const fs::path file = write(name, bytes);
    try {
      read_point_cloud(file);
      ADD_FAILURE() << "accepted";
    } catch (const CloudRefused& refused) {
      const std::string message = refused.what();
      EXPECT_EQ(message.rfind(file.string() + ": ", 0), 0U) << message;
      EXPECT_LT(message.size(), file.string().size() + 300) << message;
      for (const char c : message) EXPECT_TRUE(c >= ' ' && c <= '~') << message;
      for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
    }
  }

  const OrientedPointCloud cloud_ = spiral_sphere();
  const std::string floats_ = binary_rows<float>(cloud_);
  const std::string text_ = text_rows(cloud_);

 private:
  fs::path folder_;
};

// Coordinates up to 3.1: half a float ulp there is 1.2e-7.
constexpr double kFloatRounding = 1.3e-7;

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

// Any byte of a good file may be wrong: the outcome is a cloud or a refusal, never anything else.
TEST_F(PointCloudIo, DamagedBytesNeverEscape) {
  const std::string floats = by_fields<float>(cloud_), packed = lzf_literals(floats);
  const std::pair<std::string, std::string> good[] = {
      {"a.ply", ply("binary_little_endian", "float", "100", "element face 1\nproperty list uchar int v\n") + floats_ +
                    std::string("\1\0\0\0\0", 5)},
      {"b.ply", ply("ascii") + text_},
      {"c.pcd", pcd("ascii") + text_},
      {"d.pcd", pcd("binary") + floats_},
      {"e.pcd", pcd("binary_compressed") + compressed_block(static_cast<std::uint32_t>(packed.size()),
                                                            static_cast<std::uint32_t>(floats.size()), packed)},
      {"f.xyz", text_}};
  std::mt19937 generator(3);
  int n_refused = 0;
  for (const auto& [name, bytes] : good) {
    for (int trial = 0; trial < 150; ++trial) {
      std::string damaged = bytes;
      // Most of the structure is in the first 300 bytes.
      const std::size_t range = trial % 2 == 0 ? std::min<std::size_t>(300, bytes.size()) : bytes.size();
      for (int hit = 0; hit < 3; ++hit) damaged[generator() % range] = static_cast<char>(generator());
      if (trial % 5 == 0) damaged.resize(generator() % damaged.size());
      try {
        const CloudFile file = read(name, damaged);
        EXPECT_LE(file.cloud.points.size(), 110U);
      } catch (const CloudRefused&) {
        ++n_refused;
      }
    }
  }
  EXPECT_GT(n_refused, 300);
}

TEST_F(PointCloudIo, XyzIsReadWithBlanksTabsCommasAndComments) {
  expect_cloud("blanks.xyz", "# x y z nx ny nz\n\n" + text_, cloud_);
  expect_cloud("tabs.txt", "//X Y Z Nx Ny Nz\r\n" + text_rows(cloud_, "\t", "\r\n"), cloud_);
  expect_cloud("commas.xyz", text_rows(cloud_, ","), cloud_);
  expect_cloud("both.XYZ", text_rows(cloud_, ", "), cloud_);
  expect_cloud("counted.pts", "100\n" + text_, cloud_);
  expect_cloud("plus.xyz", replaced(text_, "1", "+1"), cloud_);
}

/// Rows of the cloud with a last column.
std::string labelled_rows(const OrientedPointCloud& cloud, const std::function<std::string(int)>& label) {
  std::istringstream rows(text_rows(cloud));
  std::string line, text;
  for (int i = 0; std::getline(rows, line); ++i) text += line + " " + label(i) + "\n";
  return text;
}

TEST_F(PointCloudIo, LabelsComeFromEveryFormat) {
  OrientedPointCloud cloud = cloud_;
  for (int i = 0; i < 100; ++i) cloud.labels.push_back(i % 7 - 3);
  const std::string text = labelled_rows(cloud, [&](int i) { return std::to_string(cloud.labels[i]); });
  std::string binary_ply, binary_pcd;
  for (int i = 0; i < 100; ++i) {
    const std::string row = floats_.substr(24 * static_cast<std::size_t>(i), 24);
    binary_ply += row;
    put(binary_ply, static_cast<std::int8_t>(cloud.labels[i]));
    binary_pcd += row;
    put(binary_pcd, std::int32_t{cloud.labels[i]});
  }
  const auto labelled_pcd = [](const std::string& data) {
    std::string header = pcd(data);
    for (const auto& [from, to] : {std::pair{"normal_z\n", "normal_z label\n"},
                                   {"SIZE 4", "SIZE 4 4"},
                                   {"F F F F F F", "F F F F F F I"},
                                   {"COUNT 1", "COUNT 1 1"}}) {
      header.replace(header.find(from), std::string(from).size(), to);
    }
    return header;
  };
  std::ostringstream ours;
  write_ply(ours, cloud);
  const std::vector<std::pair<std::string, std::string>> files = {
      {"ascii.ply", ply("ascii", "float", "100", "property int label\n") + text},
      {"patch.ply", ply("ascii", "float", "100", "property float patch\n") + text},
      {"binary.ply", ply("binary_little_endian", "float", "100", "property char label\n") + binary_ply},
      {"ours.ply", ours.str()},
      {"ascii.pcd", labelled_pcd("ascii") + text},
      {"binary.pcd", labelled_pcd("binary") + binary_pcd},
      {"seven.xyz", text}};
  for (const auto& [name, bytes] : files) EXPECT_EQ(read(name, bytes).cloud.labels, cloud.labels) << name;
  EXPECT_TRUE(read("none.xyz", text_).cloud.labels.empty());
  // Three coordinates and a label; points that are no numbers go with theirs.
  std::string four = "nan 0 0 77\n";
  for (int i = 0; i < 100; ++i) {
    const Vec3& x = cloud.points[i];
    four += fmt::format("{} {} {} {}\n", x.x(), x.y(), x.z(), cloud.labels[i]);
  }
  EXPECT_EQ(read_scan(write("four.xyz", four)).cloud.labels, cloud.labels);
  cloud.labels.pop_back();
  EXPECT_THROW(write_ply(ours, cloud), std::invalid_argument);
}

TEST_F(PointCloudIo, ColumnsThatAreNoLabelsAreRefused) {
  const std::string property = "property float label\n";
  for (const char* label : {"1.5", "nan", "3000000000"}) {
    const std::string rows = labelled_rows(cloud_, [&](int i) { return i == 4 ? label : "1"; });
    expect_refused("label.ply", ply("ascii", "float", "100", property) + rows, {"point 5", "label"});
  }
  const std::string intensities = labelled_rows(cloud_, [](int i) { return std::to_string(i); });
  expect_refused("many.xyz", intensities, {"100 different", "64"});
  EXPECT_EQ(read("many.ply", ply("ascii", "float", "100", "property int label\n") + intensities).cloud.labels[99], 99);
  expect_refused("leica.pts", "100\n" + labelled_rows(cloud_, [](int) { return "1"; }), {"intensities"});
  std::string colours;
  for (const Vec3& x : cloud_.points) colours += fmt::format("{} {} {} 12 200 17 3\n", x.x(), x.y(), x.z());
  expect_refused("colours.xyz", colours, {"no normals"});
}

TEST_F(PointCloudIo, MalformedXyzIsRefusedWithTheReason) {
  expect_refused("three.xyz", "1 2 3\n", {"line 1", "no normals"});
  expect_refused("eight.xyz", "# head\n1 2 3 0 0 1 7 8\n", {"line 2", "8 columns"});
  expect_refused("word.xyz", "x y z nx ny nz\n" + text_, {"line 1", "'x'"});
  std::string commas = text_;
  std::replace(commas.begin(), commas.end(), '.', ',');
  expect_refused("commas.xyz", commas, {"line 1", "decimal"});
  expect_refused("commas_three.xyz", "0,1 0,2 0,3\n", {"line 1", "decimal"});  // six columns if commas separated
  expect_refused("semicolons.xyz", "0,1;0,2;0,3;0,0;0,0;1,0\n", {"line 1"});
  expect_refused("random.xyz", random_bytes(5000), {"line 1"});
  expect_refused("empty.xyz", "", {"empty"});
  expect_refused("nine.xyz", text_rows(spiral_sphere(9)), {"9 points", "10"});
  expect_refused("counted.pts", "101\n" + text_, {"101", "100"});
  expect_refused("large.xyz", with_line(text_, 6, "1e999 0 0 0 0 1"), {"line 7"});
  expect_refused("infinite.xyz", with_line(with_line(text_, 6, "inf 0 0 0 0 1"), 9, "0 nan 0 0 0 1"),
                 {"point 7 ", "2 such"});
  expect_refused("huge.xyz", with_line(text_, 6, "1e51 0 0 0 0 1"), {"point 7 ", "1e50"});
  expect_refused("zero_normal.xyz", with_line(text_, 6, "0 0 0 0 -0 0"), {"point 7 ", "zero normal"});
  expect_refused("cloud.las", text_, {".xyz"});
}

TEST_F(PointCloudIo, ScansMayLackNormalsAndHoldPointsThatAreNoNumbers) {
  const OrientedPointCloud cloud = spiral_sphere(50);
  std::string bare, rows = text_rows(cloud);
  for (const Vec3& x : cloud.points) {
    std::ostringstream row;
    row.precision(17);
    row << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
    bare += row.str();
  }
  const CloudFile without = read_scan(write("bare.xyz", bare));
  EXPECT_EQ(without.cloud.points, cloud.points);
  EXPECT_TRUE(without.cloud.normals.empty());

  const CloudFile spoiled =
      read_scan(write("spoiled.xyz", rows + "nan 0 0 1 0 0\n0 inf 0 1 0 0\n1 2 3 0 0 0\n1 2 3 nan 0 0\n"));
  EXPECT_EQ(spoiled.report.n_points, 54U);
  EXPECT_EQ(spoiled.report.n_points_dropped, 2U);
  EXPECT_EQ(spoiled.report.n_normals_missing, 2U);
  ASSERT_EQ(spoiled.cloud.points.size(), 52U);
  EXPECT_EQ(spoiled.cloud.normals[51], Vec3::Zero());
  EXPECT_EQ(spoiled.cloud.normals[3], cloud.normals[3]);

  std::string header = "ply\nformat ascii 1.0\nelement vertex 50\n";
  for (const char* axis : {"x", "y", "z"}) header += "property double " + std::string(axis) + "\n";
  EXPECT_EQ(read_scan(write("bare.ply", header + "end_header\n" + bare)).cloud.points, cloud.points);

  std::string mostly_bad = bare;
  for (int i = 0; i < 51; ++i) mostly_bad += "nan 0 0\n";
  EXPECT_THROW(read_scan(write("bad.xyz", mostly_bad)), CloudRefused);
  EXPECT_THROW(read_scan(write("mixed.xyz", bare + rows)), CloudRefused);
  EXPECT_THROW(read_scan(write("two.xyz", "1 2\n3 4\n")), CloudRefused);
}

OrientedPointCloud scaled_to(OrientedPointCloud cloud, double factor) {
  for (Vec3& x : cloud.points) x *= factor;
  return cloud;
}

TEST_F(PointCloudIo, PointsThatBoundNoBodyAreRefused) {
  const auto rows = [](auto&& point) {
    std::string text;
    for (int i = 0; i < 40; ++i) {
      const Vec3 x = point(i);
      for (int d = 0; d < 3; ++d) text += std::to_string(x[d]) + ' ';
      text += "0 0 1\n";
    }
    return text;
  };
  expect_refused("one_place.xyz", rows([](int) { return Vec3(1, 2, 3); }), {"1 different places"});
  expect_refused("corners.xyz", rows([](int i) { return Vec3(i & 1, i >> 1 & 1, i >> 2 & 1); }),
                 {"8 different places"});
  expect_refused("line.xyz", rows([](int i) { return Vec3(i, 2 * i, 5); }), {"one line"});
  expect_refused("tiny.xyz", text_rows(scaled_to(cloud_, 1e-52)), {"1e-50"});
  expect_refused("plane.xyz", rows([](int i) { return Vec3(i % 7, i / 7, i % 7 + i / 7); }), {"one plane"});
}

TEST_F(PointCloudIo, TheContentDecidesBeforeTheExtension) {
  expect_cloud("really_ply.xyz", ply("ascii") + text_, cloud_);
  expect_cloud("really_pcd.ply", pcd("ascii") + text_, cloud_);
}

TEST_F(PointCloudIo, NormalsAreMadeUnitAndCounted) {
  OrientedPointCloud scaled = cloud_;
  scaled.normals[3] *= 1e-310;  // its square is no double
  scaled.normals[5] *= 1e300;
  scaled.normals[7] *= 1 + 5e-4;  // below what is worth telling
  const CloudFile file = read("scaled.xyz", text_rows(scaled));
  EXPECT_EQ(file.report.n_normals_rescaled, 2U);
  for (std::size_t i = 0; i < cloud_.normals.size(); ++i) {
    EXPECT_NEAR(file.cloud.normals[i].norm(), 1, 1e-14);
    // 1e-310 is subnormal: 43 of the 53 bits are left.
    EXPECT_NEAR((file.cloud.normals[i] - cloud_.normals[i]).norm(), 0, i == 3 ? 1e-12 : 1e-15);
  }
}

TEST_F(PointCloudIo, WrittenCloudsAreReadBackBitByBit) {
  std::ostringstream out;
  write_ply(out, read("rescaled.xyz", text_rows(cloud_)).cloud);
  const CloudFile first = read("first.ply", out.str());
  EXPECT_EQ(first.report.format, "ply binary little endian");
  std::ostringstream again;
  write_ply(again, first.cloud);
  EXPECT_EQ(out.str(), again.str());
}

TEST_F(PointCloudIo, FilesThatCannotBeOpenedAreSystemErrors) {
  EXPECT_THROW(read_point_cloud("/no/such/cloud.ply"), std::system_error);
  EXPECT_THROW(read_point_cloud(fs::temp_directory_path()), std::system_error);
  try {
    read_point_cloud("/no/such/cloud.ply");
  } catch (const std::system_error& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/cloud.ply"), std::string::npos);
  }
}

TEST(PointCloudIoScans, RealCloudsHaveTheirPoints) {
  const char* shared = std::getenv("UMTET_SHARED");
  const fs::path data = fs::path(shared != nullptr ? shared : UMTET_SOURCE_DIR "/../shared") / "data";
  if (!fs::exists(data / "duck.ply")) GTEST_SKIP() << "no scans at " << data;
  EXPECT_EQ(read_point_cloud(data / "duck.ply").cloud.points.size(), 5344U);
  EXPECT_EQ(read_point_cloud(data / "spot_ascii.ply").cloud.points.size(), 2930U);
  EXPECT_EQ(read_point_cloud(data / "blub.xyz").cloud.points.size(), 7106U);
  EXPECT_EQ(read_point_cloud(data / "bunny_holes.pcd").cloud.points.size(), 34834U);
  EXPECT_THROW(read_point_cloud(data / "cat_no_normals.xyz"), CloudRefused);
}

}  // namespace
}  // namespace umtet
