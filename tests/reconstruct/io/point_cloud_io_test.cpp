// Clouds in and out, whatever the format; XYZ; labels. What is refused is in tests/corpus.

#include "tests/reconstruct/io/point_cloud_io_fixture.h"

namespace umtet {
namespace {

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
  const std::string counted = labelled_rows(cloud_, [](int i) { return std::to_string(i); });
  EXPECT_EQ(read("many.ply", ply("ascii", "float", "100", "property int label\n") + counted).cloud.labels[99], 99);
  cloud.labels.pop_back();
  EXPECT_THROW(write_ply(ours, cloud), std::invalid_argument);
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

/// A refusal's text.
std::string refusal(const std::function<void()>& reads) {
  try {
    reads();
  } catch (const CloudRefused& e) {
    return e.what();
  }
  return "";
}

TEST_F(PointCloudIo, FilesOfSeveralBlocksAreReadAsTheyAre) {
  // 2.9 MB: a beginning of a megabyte and two blocks, of which borders of points are none.
  const OrientedPointCloud large = spiral_sphere(60001);
  const std::string rows = binary_rows<double>(large), n = "60001";
  const std::string header = ply("binary_little_endian", "double", n);
  expect_cloud("large.ply", header + rows, large);
  expect_cloud("big_endian.ply", ply("binary_big_endian", "double", n) + binary_rows<double>(large, true), large);
  expect_cloud("padded.ply", header + rows + std::string(3 << 20, '\n'), large);

  const std::string cut = refusal([&] { read("cut.ply", header + rows.substr(0, rows.size() - 20)); });
  EXPECT_NE(cut.find("60001"), std::string::npos) << cut;
  const std::string surplus = refusal([&] { read("more.ply", header + rows + std::string(2 << 20, ' ') + "x"); });
  EXPECT_NE(surplus.find(fmt::format("byte {}: data go on", header.size() + rows.size() + (2 << 20))),
            std::string::npos)
      << surplus;

  // Lists of any length before and behind the points, one of them longer than a block.
  const std::string head = header.substr(0, header.find("element")) +
                           "element first 1\nproperty list int uchar some\n" + header.substr(header.find("element"));
  std::string list;
  put(list, std::int32_t{5 << 20});
  list += std::string(5 << 20, 'a');
  expect_cloud("list.ply", head + list + rows, large);
}

TEST_F(PointCloudIo, PcdOfSeveralBlocksIsReadAsItIs) {
  const OrientedPointCloud large = spiral_sphere(60001);
  const std::string header = pcd("binary", "8", "1", "60001", "60001");
  const std::string rows = binary_rows<double>(large);
  expect_cloud("large.pcd", header + rows, large);
  EXPECT_THROW(read("cut.pcd", header + rows.substr(0, rows.size() - 20)), CloudRefused);
  EXPECT_THROW(read("more.pcd", header + rows + std::string(2 << 20, ' ') + "x"), CloudRefused);
}

}  // namespace
}  // namespace umtet
