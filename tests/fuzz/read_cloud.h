#pragma once

#include <cstdlib>
#include <sstream>
#include <string>

#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/io/point_cloud_io.h"
#include "tests/fuzz/input_file.h"

namespace umtet::fuzz {

/// Whether a file of ours of it has what it has.
inline bool is_read_back(const OrientedPointCloud& cloud) {
  static const InputFile again(".again.ply");
  std::ostringstream out;
  write_ply(out, cloud);
  const std::string bytes = out.str();
  try {
    const std::filesystem::path& path = again.write(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    return field_names(read_point_cloud(path).cloud) == field_names(cloud);
  } catch (const CloudRefused&) {
    return false;
  }
}

/// A cloud of finite numbers with unit normals, no more points than the file has bytes, or a refusal. Of names only
/// what our own files can hold.
/// @param columns  of a text, besides those that it says itself
inline int read_cloud(const InputFile& file, const std::uint8_t* data, std::size_t size, const char* columns = "") {
  const std::filesystem::path& path = file.write(data, size);
  struct Reading {
    CloudFile (*read)(const std::filesystem::path&, const std::string&);
    const char* columns;
  };
  for (const auto& [read, told] :
       {Reading{read_scan, ""}, Reading{read_point_cloud, ""}, Reading{read_scan, columns}}) {
    try {
      const OrientedPointCloud cloud = read(path, told).cloud;
      // LZF packs at most 264 bytes into 3, and a point has at least three.
      require(cloud.points.size() <= 30 * size);
      for_each_array(cloud,
                     [&](const auto& array, const std::string&) { require(array.size() == cloud.points.size()); });
      require(cloud.fields.size() <= kMostFields);
      for (const Vec3& x : cloud.points) require(x.allFinite());
      for (const Vec3& n : cloud.normals) require(n.isZero(0) || std::abs(n.norm() - 1) < 1e-12);
      if (read == read_point_cloud) require(is_read_back(cloud));
    } catch (const CloudRefused&) {
    }
  }
  return 0;
}

}  // namespace umtet::fuzz
