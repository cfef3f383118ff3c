#pragma once

#include <cstddef>

#include "common/vec3.h"

namespace umtet {

/// A defect of kind Missed: adjacent samples whose distance from the mesh is larger than their noise and the flatness
/// of the faces explain.
struct MissedPlace {
  Vec3 farthest = Vec3::Zero();  ///< the sample that is farthest from the mesh; model coordinates
  double distance = 0;           ///< distance of this sample, model units
  std::size_t n_samples = 0;
};

}  // namespace umtet
