#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Encoding of the data of a PCD file.
enum class PcdData { Ascii, Binary, Compressed };

/// A field of the points in a PCD file.
struct PcdField {
  std::string name;
  char kind = 'F';         ///< 'F' floating point, 'I' signed, 'U' unsigned
  std::size_t size = 0;    ///< bytes of one value: F 4 8, I and U 1 2 4 8
  std::size_t count = 1;   ///< values per point
  std::size_t offset = 0;  ///< byte in a point; for compressed files, in the unpacked point
};

/// Header of a PCD file.
struct PcdHeader {
  PcdData data = PcdData::Ascii;
  std::vector<PcdField> fields;  ///< without the padding fields "_" in compressed files, as in their data
  std::size_t n_points = 0;
  std::size_t point_bytes = 0;
  std::optional<Vec3> viewpoint;  ///< position of the scanner; none for the default (0 0 0 1 0 0 0)
  std::size_t body = 0;           ///< position of the data in the file
  std::size_t body_line = 0;      ///< line of the data, from 1
};

/// Parses the header of a PCD file, and checks that a binary body lies within the file.
/// \throw CloudRefused with the invalid line or byte
PcdHeader parse_pcd_header(const CloudSource& source);

}  // namespace umtet::detail
