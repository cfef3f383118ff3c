#pragma once

#include <cstdlib>

#include "reconstruct/io/point_cloud_io.h"
#include "tests/fuzz/input_file.h"

namespace umtet::fuzz {

/// A cloud of finite numbers with unit normals, no more points than the file has bytes, or a refusal.
inline int read_cloud(const InputFile& file, const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path& path = file.write(data, size);
  for (const auto read : {read_scan, read_point_cloud}) {
    try {
      const OrientedPointCloud cloud = read(path).cloud;
      // LZF packs at most 264 bytes into 3, and a point has at least three.
      require(cloud.points.size() <= 30 * size);
      require(cloud.normals.empty() || cloud.normals.size() == cloud.points.size());
      require(cloud.labels.empty() || cloud.labels.size() == cloud.points.size());
      for (const Vec3& x : cloud.points) require(x.allFinite());
      for (const Vec3& n : cloud.normals) require(n.isZero(0) || std::abs(n.norm() - 1) < 1e-12);
    } catch (const CloudRefused&) {
    }
  }
  return 0;
}

}  // namespace umtet::fuzz
