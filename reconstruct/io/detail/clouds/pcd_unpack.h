#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/io/detail/clouds/pcd_header.h"

namespace umtet::detail {

/// Unpacks the points of a binary_compressed file: n_points * point_bytes bytes, point by point.
/// \throw CloudRefused if the block is damaged
std::vector<std::uint8_t> unpack(const CloudSource& source, const PcdHeader& header);

}  // namespace umtet::detail
