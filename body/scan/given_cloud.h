#pragma once

#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// A cloud in memory as read_scan() gives one of a file, so that the same samples make the same mesh: normals are unit,
/// to the last bit by the same rule, and unusable ones are zero.
/// @param cloud  model coordinates; normals, labels and origins are of all points or of none
/// \throw std::invalid_argument  a point that is not finite or beyond 1e50; an array of another length
CloudFile given_cloud(OrientedPointCloud cloud);

}  // namespace umtet
