#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

enum class PlyFormat { Ascii, BinaryLittleEndian, BinaryBigEndian };
enum class PlyType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

/// Size of a value in bytes.
std::size_t byte_size(PlyType type);

/// A scalar, or a list: its length as count_type, then that many values.
struct PlyProperty {
  std::string name;
  PlyType type = PlyType::Float32;
  bool is_list = false;
  PlyType count_type = PlyType::UInt8;
};

/// An element of a PLY file: its count and properties.
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< as announced: has to be compared with the size of the file
  std::vector<PlyProperty> properties;
};

/// Header of a PLY file.
struct PlyHeader {
  PlyFormat format = PlyFormat::Ascii;
  std::vector<PlyElement> elements;  ///< exactly one is named "vertex"
  std::size_t body = 0;              ///< position of the data in the file
  std::size_t body_line = 0;         ///< line of the data, from 1
};

/// Parses the header of a PLY file. \throw CloudRefused with the invalid line
PlyHeader parse_ply_header(const CloudSource& source);

}  // namespace umtet::detail
