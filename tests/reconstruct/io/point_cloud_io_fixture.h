#pragma once

// Clouds as files of bytes.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "reconstruct/io/point_cloud_io.h"
#include "tests/reconstruct/cloud/cloud_corpus.h"

namespace umtet {

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

  const OrientedPointCloud cloud_ = spiral_sphere();
  const std::string floats_ = binary_rows<float>(cloud_);
  const std::string text_ = text_rows(cloud_);

 private:
  fs::path folder_;
};

// Coordinates up to 3.1: half a float ulp there is 1.2e-7.
inline constexpr double kFloatRounding = 1.3e-7;

}  // namespace umtet
