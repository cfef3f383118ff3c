#include "mesh/io/points_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <sstream>

namespace umtet {
namespace {

namespace fs = std::filesystem;

struct PointsFile : ::testing::Test {
  fs::path path = fs::temp_directory_path() / ("umtet_points_" + std::to_string(::getpid()) + ".vtp");
  ~PointsFile() override { fs::remove(path); }
};

TEST_F(PointsFile, ComesBackBitForBit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Vec3> points;
  std::map<std::string, FieldValues> data = {
      {"mark", std::vector<std::uint8_t>()}, {"id", std::vector<std::int64_t>()}, {"off", std::vector<double>()}};
  for (int k = 0; k < 1000; ++k) {
    points.emplace_back(any(random), any(random), any(random));
    std::get<std::vector<std::uint8_t>>(data["mark"]).push_back(static_cast<std::uint8_t>(k % 256));
    std::get<std::vector<std::int64_t>>(data["id"]).push_back(std::int64_t{k} << 40);
    std::get<std::vector<double>>(data["off"]).push_back(any(random));
  }
  write_vtp(path, points, data);
  const PointFile read = read_points(path);
  EXPECT_EQ(read.points, points);
  EXPECT_EQ(read.point_data, data);
  write_vtp(path, {}, {{"mark", std::vector<std::uint8_t>()}});
  EXPECT_TRUE(read_points(path).points.empty());
}

TEST_F(PointsFile, IsRefusedWhereItIsCutOff) {
  write_vtp(path, {{1, 2, 3}, {4, 5, 6}}, {{"mark", std::vector<std::uint8_t>{1, 2}}});
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  const std::string whole = text.str();
  for (std::size_t n = 0; n + 1 < whole.size(); n += 7) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, n);
    EXPECT_THROW(read_points(path), MeshFileRefused) << n;
  }
}

}  // namespace
}  // namespace umtet
