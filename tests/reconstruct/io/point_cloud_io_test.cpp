// Clouds in and out, whatever the format; XYZ; labels.

#include "tests/reconstruct/io/point_cloud_io_fixture.h"

namespace umtet {
namespace {

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

// 64 GB of zeros: no machine of a test holds them, so they are refused by their beginning.
TEST_F(PointCloudIo, WhatHasNoLinesIsRefusedBeforeItIsRead) {
  for (const char* name : {"zeros.ply", "zeros.pcd", "zeros.xyz"}) {
    const fs::path file = write(name, "");
    fs::resize_file(file, std::uintmax_t{1} << 36);
    EXPECT_THROW(read_scan(file), CloudRefused) << name;
  }
  expect_refused("one_line.xyz", text_ + std::string(1 << 17, '1'), {"line 101: 131072 bytes long"});
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
