#pragma once

#include <cstddef>

#include "common/vec3.h"

namespace umtet {

/// Samples beside one another that the mesh passes by: neither their noise nor the flatness of its faces explains how
/// far off they are.
struct MissedPlace {
  Vec3 farthest = Vec3::Zero();  ///< the sample that is farthest from the mesh; model coordinates
  double distance = 0;           ///< of it; model units
  std::size_t n_samples = 0;
};

}  // namespace umtet
