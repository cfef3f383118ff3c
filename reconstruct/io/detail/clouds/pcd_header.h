#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

enum class PcdData { Ascii, Binary, Compressed };

struct PcdField {
  std::string name;
  char kind = 'F';         ///< 'F' floating point, 'I' signed, 'U' unsigned
  std::size_t size = 0;    ///< bytes of one value: F 4 8, I and U 1 2 4 8
  std::size_t count = 1;   ///< values per point
  std::size_t offset = 0;  ///< byte in a point; in compressed files, of the unpacked point
};

struct PcdHeader {
  PcdData data = PcdData::Ascii;
  std::vector<PcdField> fields;  ///< compressed files leave the padding fields "_" out, and so does this list
  std::size_t n_points = 0;
  std::size_t point_bytes = 0;
  std::optional<Vec3> viewpoint;  ///< where the scanner stood; none by default (0 0 0 1 0 0 0)
  std::size_t body = 0;           ///< byte where the data begin
  std::size_t body_line = 0;      ///< and its line, from 1
};

/// Header of a PCD file whose binary body, if it has one, lies within the file.
/// \throw CloudRefused  with the line or byte that is wrong
PcdHeader parse_pcd_header(const CloudSource& source);

}  // namespace umtet::detail
