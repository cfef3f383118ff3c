#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <sstream>
#include <string>

#include "reconstruct/cloud/point_cloud.h"

/// Pieces of cloud files, good ones; tests/corpus puts them together wrongly.
namespace umtet {

/// Golden-spiral sphere with outward normals; coordinates need all 53 bits.
inline OrientedPointCloud spiral_sphere(int n = 100) {
  OrientedPointCloud cloud;
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z);
    cloud.normals.push_back(Vec3(r * std::cos(i * golden_angle), r * std::sin(i * golden_angle), z).normalized());
    cloud.points.push_back(0.1 * cloud.normals.back() + Vec3(1, 2, 3));
  }
  return cloud;
}

template <class T>
void put(std::string& bytes, T value, bool big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

template <class T>
inline std::string binary_rows(const OrientedPointCloud& cloud, bool big_endian = false) {
  std::string bytes;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (int a = 0; a < 3; ++a) put(bytes, static_cast<T>(cloud.points[i][a]), big_endian);
    for (int a = 0; a < 3; ++a) put(bytes, static_cast<T>(cloud.normals[i][a]), big_endian);
  }
  return bytes;
}

inline std::string text_rows(const OrientedPointCloud& cloud, const char* separator = " ", const char* end = "\n") {
  std::ostringstream out;
  out.precision(17);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vec3 &x = cloud.points[i], &n = cloud.normals[i];
    out << x.x() << separator << x.y() << separator << x.z() << separator << n.x() << separator << n.y() << separator
        << n.z() << end;
  }
  return out.str();
}

inline std::string properties(const std::string& type) {
  std::string lines;
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) lines += "property " + type + " " + name + "\n";
  return lines;
}

/// Header of 100 vertices unless count says otherwise; `more` goes before end_header.
inline std::string ply(const std::string& format, const std::string& type = "float", const std::string& count = "100",
                       const std::string& more = "") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + count + "\n" + properties(type) + more + "end_header\n";
}

inline std::string pcd(const std::string& data, const std::string& size = "4", const std::string& count = "1",
                       const std::string& width = "100", const std::string& points = "100") {
  std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\n";
  header += "SIZE " + size + " " + size + " " + size + " " + size + " " + size + " " + size + "\nTYPE F F F F F F\n";
  header += "COUNT " + count + " 1 1 1 1 1\nWIDTH " + width + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points;
  return header + "\nDATA " + data + "\n";
}

/// LZF without back references: runs of up to 32 bytes, each after a byte that holds its length - 1.
inline std::string lzf_literals(const std::string& bytes) {
  std::string packed;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

/// Compressed PCD holds field after field.
template <class T>
inline std::string by_fields(const OrientedPointCloud& cloud) {
  std::string bytes;
  for (const auto* vectors : {&cloud.points, &cloud.normals})
    for (int a = 0; a < 3; ++a)
      for (const Vec3& v : *vectors) put(bytes, static_cast<T>(v[a]));
  return bytes;
}

inline std::string compressed_block(std::uint32_t packed_size, std::uint32_t unpacked_size, const std::string& packed) {
  std::string bytes;
  put(bytes, packed_size);
  put(bytes, unpacked_size);
  return bytes + packed;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace umtet
