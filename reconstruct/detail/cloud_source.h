#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/point_cloud_io.h"

namespace umtet::detail {

/// A cloud file in memory, and its name for messages. The bytes outlive every reader.
struct CloudSource {
  std::string name;
  std::string_view bytes;
};

/// \throw CloudRefused  always: "NAME: what"
[[noreturn]] void refuse(const CloudSource& source, const std::string& what);

/// A piece of a file as it may be shown on a terminal: quoted, clipped to 40 characters, unprintable bytes as '?'.
std::string in_quotes(std::string_view text);

/// Where x, y, z and the normal (nx ny nz or normal_x normal_y normal_z) are among `names`.
/// \throw CloudRefused  one of them missing or there twice; `kind` ("property", "field") is the format's word for them
std::array<std::size_t, 6> oriented_columns(const CloudSource& source, const std::vector<std::string>& names,
                                            std::string_view kind);

/// Appends the point (x, y, z) and normal (nx, ny, nz) found in values at columns.
void append_point(OrientedPointCloud& cloud, const std::vector<double>& values,
                  const std::array<std::size_t, 6>& columns);

/// \throw CloudRefused  anything but blanks and NUL padding from `offset` on: then a count of the header is wrong
void refuse_surplus(const CloudSource& source, std::size_t offset);

/// One reader per format. They check the shape of the file; what the numbers are is checked by read_point_cloud.
/// \throw CloudRefused
CloudFile read_ply(const CloudSource& source);
CloudFile read_pcd(const CloudSource& source);
CloudFile read_xyz(const CloudSource& source);

}  // namespace umtet::detail
