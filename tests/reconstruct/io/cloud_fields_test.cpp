// Colours and fields of samples, whatever the format.

#include <bit>
#include <cmath>

#include "tests/reconstruct/io/point_cloud_io_fixture.h"

namespace umtet {
namespace {

double temperature(std::size_t i) { return 20.5 + .25 * static_cast<double>(i); }
Colour colour(std::size_t i) {
  return {static_cast<std::uint8_t>(2 * i), static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(i + 7)};
}
/// As PCL packs it.
std::uint32_t packed(std::size_t i, std::uint32_t alpha) {
  const Colour c = colour(i);
  return alpha << 24 | std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | c[2];
}

template <class T>
void put(std::string& bytes, T value, bool swap = false) {
  std::string some(reinterpret_cast<const char*>(&value), sizeof(T));
  if (swap) std::reverse(some.begin(), some.end());
  bytes += some;
}

class CloudFields : public PointCloudIo {
 protected:
  /// Rows of text with more columns.
  std::string rows(const std::function<std::string(std::size_t)>& more) const {
    std::istringstream in(text_);
    std::string line, text;
    for (std::size_t i = 0; std::getline(in, line); ++i) text += line + " " + more(i) + "\n";
    return text;
  }
  /// Rows of floats with more bytes.
  std::string floats(const std::function<void(std::string&, std::size_t)>& more, bool swap = false) const {
    std::string bytes;
    for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
      for (const Vec3& v : {cloud_.points[i], cloud_.normals[i]}) {
        for (const double c : v) put(bytes, static_cast<float>(c), swap);
      }
      more(bytes, i);
    }
    return bytes;
  }
  static void expect_fields(const OrientedPointCloud& cloud, const std::string& name = "temperature") {
    ASSERT_EQ(cloud.fields.size(), 1u);
    EXPECT_EQ(cloud.fields[0].name, name);
    ASSERT_EQ(cloud.fields[0].values.size(), cloud.points.size());
    for (std::size_t i = 0; i < cloud.points.size(); ++i) EXPECT_EQ(cloud.fields[0].values[i], temperature(i));
  }
  static void expect_colours(const OrientedPointCloud& cloud) {
    ASSERT_EQ(cloud.colours.size(), cloud.points.size());
    for (std::size_t i = 0; i < cloud.points.size(); ++i) ASSERT_EQ(cloud.colours[i], colour(i)) << i;
  }
  static std::string text_of(const Colour& c, double unit = 1) {
    return fmt::format("{} {} {}", c[0] / unit, c[1] / unit, c[2] / unit);
  }
};

/// The header of a PCD of x y z normals and more fields.
std::string with_fields(const std::string& data, const std::string& names, const std::string& sizes,
                        const std::string& types, const std::string& counts) {
  std::string header = pcd(data);
  for (const auto& [line, more] : {std::pair{"FIELDS", names}, {"SIZE", sizes}, {"TYPE", types}, {"COUNT", counts}}) {
    header.insert(header.find('\n', header.find(line)), " " + more);
  }
  return header;
}

TEST_F(CloudFields, PlyHasThemInEveryEncoding) {
  const std::string bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  const std::string scalar = "property double temperature\n";
  for (const bool swap : {false, true}) {
    const std::string body = floats(
        [&](std::string& out, std::size_t i) {
          for (const std::uint8_t c : colour(i)) put(out, c);
          put(out, std::uint8_t{255});
          put(out, temperature(i), swap);
        },
        swap);
    const std::string format = swap ? "binary_big_endian" : "binary_little_endian";
    const CloudFile file = read("binary.ply", ply(format, "float", "100", bytes + scalar) + body);
    expect_fields(file.cloud);
    expect_colours(file.cloud);
    EXPECT_TRUE(file.report.fields_left_out.empty());
  }
  const std::string ascii =
      rows([](std::size_t i) { return fmt::format("{} 255 {}", text_of(colour(i)), temperature(i)); });
  const CloudFile file = read("ascii.ply", ply("ascii", "float", "100", bytes + scalar) + ascii);
  expect_fields(file.cloud);
  expect_colours(file.cloud);
}

TEST_F(CloudFields, ColoursInFloatingPointAreFromZeroToOne) {
  const std::string floats = "property float red\nproperty float green\nproperty float blue\n";
  expect_colours(read("float.ply", ply("ascii", "float", "100", floats) +
                                       rows([](std::size_t i) { return text_of(colour(i), 255); }))
                     .cloud);
  const std::string shorts = "property ushort red\nproperty ushort green\nproperty ushort blue\n";
  expect_colours(read("short.ply", ply("ascii", "float", "100", shorts) +
                                       rows([](std::size_t i) { return text_of(colour(i), 1. / 257); }))
                     .cloud);
  const auto odd = read("odd.ply", ply("ascii", "float", "100", floats) + rows([](std::size_t) { return "nan -1 7"; }));
  EXPECT_EQ(odd.cloud.colours[5], (Colour{0, 0, 255}));
}

TEST_F(CloudFields, PackedColoursOfPcdComeOutWhateverTheirTypeAndAlpha) {
  for (const char* name : {"rgb", "rgba"}) {
    for (const std::uint32_t alpha : {0u, 254u, 255u}) {
      SCOPED_TRACE(fmt::format("{} {}", name, alpha));
      const std::string body = floats([&](std::string& out, std::size_t i) {
        put(out, packed(i, alpha));  // with alpha 255 and red from 128 on this is no number as a float
        put(out, static_cast<float>(temperature(i)));
      });
      for (const char* type : {"F F", "U F"}) {
        const CloudFile file =
            read("binary.pcd", with_fields("binary", std::string(name) + " temperature", "4 4", type, "1 1") + body);
        expect_fields(file.cloud);
        expect_colours(file.cloud);
      }
      const std::string whole =
          rows([&](std::size_t i) { return fmt::format("{} {}", packed(i, alpha), temperature(i)); });
      for (const char* type : {"F F", "U F"}) {
        const std::string header = with_fields("ascii", std::string(name) + " temperature", "4 4", type, "1 1");
        expect_colours(read("whole.pcd", header + whole).cloud);
      }
      if (alpha == 255) continue;  // of some of them NaN, which has no digits
      const std::string digits = rows(
          [&](std::size_t i) { return fmt::format("{} {}", std::bit_cast<float>(packed(i, alpha)), temperature(i)); });
      expect_colours(
          read("digits.pcd", with_fields("ascii", std::string(name) + " temperature", "4 4", "F F", "1 1") + digits)
              .cloud);
    }
  }
}

TEST_F(CloudFields, CompressedPcdHasThem) {
  std::string columns = by_fields<float>(cloud_);
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) put(columns, packed(i, 255));
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) put(columns, temperature(i));
  const std::string block = lzf_literals(columns);
  const std::string header = with_fields("binary_compressed", "rgb temperature", "4 8", "F F", "1 1");
  const CloudFile file =
      read("compressed.pcd", header + compressed_block(static_cast<std::uint32_t>(block.size()),
                                                       static_cast<std::uint32_t>(columns.size()), block));
  EXPECT_EQ(file.report.format, "pcd compressed");
  expect_fields(file.cloud);
  expect_colours(file.cloud);
}

TEST_F(CloudFields, ColumnsOfTextHaveTheNamesOfAComment) {
  const std::string body = rows([](std::size_t i) { return fmt::format("{} {}", text_of(colour(i)), temperature(i)); });
  for (const char* head :
       {"//X Y Z Nx Ny Nz R G B Temperature\n", "# written by hand\n# x,y,z,nx,ny,nz,red,g,B,Temperature\n"}) {
    const CloudFile file = read("named.xyz", head + body);
    expect_fields(file.cloud, "Temperature");
    expect_colours(file.cloud);
    EXPECT_EQ(file.cloud.normals[3], cloud_.normals[3]);
  }
  // Another number of names are none.
  EXPECT_TRUE(read("six.xyz", "# x y z and normals\n" + text_).cloud.fields.empty());
  // Values say what names do not.
  const CloudFile guessed = read("ten.xyz", "# x y z\n" + body);
  expect_fields(guessed.cloud, "intensity");
  expect_colours(guessed.cloud);
}

TEST_F(CloudFields, WhatIsNoFieldIsNone) {
  const std::string more =
      "property float sx\nproperty float sy\nproperty float sz\nproperty int label\n"
      "property float vp_x\nproperty float normal_x@\nproperty list uchar int ids\n";
  const CloudFile file =
      read("none.ply", ply("ascii", "float", "100", more) + rows([](std::size_t) { return "9 9 9 3 1 2 2 7 7"; }));
  EXPECT_EQ(file.cloud.labels.size(), 100u);
  EXPECT_EQ(file.cloud.origins.size(), 100u);
  ASSERT_EQ(file.cloud.fields.size(), 1u);  // of a name that no other thing has
  EXPECT_EQ(file.cloud.fields[0].name, "normal_x_");
  const CloudFile bare = read("bare.ply", ply("ascii") + text_);
  EXPECT_TRUE(bare.cloud.fields.empty() && bare.cloud.colours.empty());
  const std::string several = floats([](std::string& out, std::size_t) {
    for (int k = 0; k < 3; ++k) put(out, 1.f);
  });
  EXPECT_TRUE(read("several.pcd", with_fields("binary", "histogram", "4", "F", "3") + several).cloud.fields.empty());
  const std::string one = floats([](std::string& out, std::size_t) { put(out, 1.f); });
  EXPECT_TRUE(read("padding.pcd", with_fields("binary", "_", "4", "F", "1") + one).cloud.fields.empty());
}

TEST_F(CloudFields, SixteenAreKeptUnderPlainNames) {
  std::string more = "property float a<b>\nproperty float a<b>\n", values = "1 2";
  for (int k = 0; k < 20; ++k) {
    more += fmt::format("property float f{}\n", k);
    values += fmt::format(" {}", k);
  }
  const CloudFile file =
      read("many.ply", ply("ascii", "float", "100", more) + rows([&](std::size_t) { return values; }));
  ASSERT_EQ(file.cloud.fields.size(), kMostFields);
  EXPECT_EQ(file.cloud.fields[0].name, "a_b_");
  EXPECT_EQ(file.cloud.fields[0].values[50], 1);
  EXPECT_EQ(file.cloud.fields[15].name, "f14");
  EXPECT_EQ(file.report.fields_left_out, (std::vector<std::string>{"a_b_", "f15", "f16", "f17", "f18", "f19"}));
}

TEST_F(CloudFields, WrittenCloudsKeepTheirFieldsBitByBit) {
  OrientedPointCloud cloud = cloud_;
  cloud.fields = {{"t", {}}, {"u.v", {}}};
  for (std::size_t i = 0; i < 100; ++i) {
    cloud.labels.push_back(static_cast<int>(i % 3));
    cloud.colours.push_back(colour(i));
    cloud.fields[0].values.push_back(std::sqrt(static_cast<double>(i)));
    cloud.fields[1].values.push_back(i == 7 ? NAN : -1e200);
  }
  std::ostringstream out, again;
  write_ply(out, cloud);
  const CloudFile file = read("ours.ply", out.str());
  EXPECT_EQ(file.cloud.labels, cloud.labels);
  EXPECT_EQ(file.cloud.fields[0].values, cloud.fields[0].values);
  expect_colours(file.cloud);
  write_ply(again, file.cloud);
  EXPECT_EQ(out.str(), again.str());
  cloud.fields[1].values.pop_back();
  EXPECT_THROW(write_ply(out, cloud), std::invalid_argument);
}

TEST_F(CloudFields, WrittenCloudsKeepWhatTheyWereMergedOf) {
  OrientedPointCloud cloud = cloud_;
  for (std::size_t i = 0; i < 100; ++i) {
    cloud.counts.push_back(static_cast<int>(1 + 1000 * i));
    cloud.spreads.push_back(std::sqrt(static_cast<double>(i)));
  }
  for (std::size_t f = 0; f < kMostFields; ++f) cloud.fields.push_back({fmt::format("f{}", f), cloud.spreads});
  std::ostringstream out, again;
  write_ply(out, cloud);
  const CloudFile file = read("ours.ply", out.str());
  EXPECT_EQ(file.cloud.counts, cloud.counts);
  EXPECT_EQ(file.cloud.spreads, cloud.spreads);
  EXPECT_EQ(file.cloud.fields.size(), kMostFields) << "they are no fields";
  write_ply(again, file.cloud);
  EXPECT_EQ(out.str(), again.str());
  EXPECT_TRUE(read_scan(write("scan.ply", out.str())).cloud.counts.empty()) << "to a scan they are samples";
  cloud.counts[7] = 0;
  std::ostringstream none;
  write_ply(none, cloud);
  EXPECT_THROW(read("none.ply", none.str()), CloudRefused);
}

TEST_F(CloudFields, PointsThatAreNoNumbersGoWithTheirs) {
  const std::string header = ply("ascii", "float", "101", "property float temperature\n");
  const CloudFile file = read_scan(write("spoiled.ply", header + "nan 0 0 0 0 1 77\n" + rows([](std::size_t i) {
                                                          return fmt::format("{}", temperature(i));
                                                        })));
  EXPECT_EQ(file.report.n_points_dropped, 1u);
  expect_fields(file.cloud);
}

}  // namespace
}  // namespace umtet
