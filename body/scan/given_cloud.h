#pragma once

#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Converts a cloud in memory to the form that read_scan() returns for a file, so that the same samples make the same
/// mesh. Normals are normalised by the same rule, with bit-identical results, and unusable normals become zero.
/// @param cloud  samples in model coordinates; the arrays of normals, labels and origins are complete or empty
/// \throw std::invalid_argument  a point is not finite or has a coordinate beyond 1e50; an array has the wrong length
CloudFile given_cloud(OrientedPointCloud cloud);

}  // namespace umtet
