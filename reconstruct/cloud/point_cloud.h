#pragma once

#include <vector>

#include "common/vec3.h"

namespace umtet {

/// P = {(x_i, n_i)}: a sampled surface                                          [Rangarajan2018, Section 3.7]
/// Arrays of equal length, but that labels and origins may be missing; x_i in model units, n_i unit and pointing out of the body.
struct OrientedPointCloud {
  std::vector<Vec3> points;      ///< x_i
  std::vector<Vec3> normals;     ///< n_i
  std::vector<int> labels = {};    ///< which part of the surface a sample is on; or empty
  std::vector<Vec3> origins = {};  ///< where the scanner stood that saw a sample; or empty
};

}  // namespace umtet
