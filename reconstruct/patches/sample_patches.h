#pragma once

#include <vector>

#include "common/vec3.h"

namespace umtet {

/// The division of a cloud of n samples into smooth patches. One patch means that the whole body is smooth.
struct SamplePatches {
  /// Two patches that touch.
  struct Border {
    int a = 0, b = 0;    ///< the two patches, a < b
    double length = 0;   ///< estimate of the length along which they touch, model units
    double angle = 0;    ///< mean angle between the normals of both patches along the border, radians
    bool sharp = false;  ///< true: the border is accepted as a sharp edge
  };

  std::vector<int> patch;       ///< [n] patch of each sample, 0 <= patch < count
  int count = 0;                ///< number of patches
  std::vector<Vec3> normals;    ///< [n] unit outward normals, filtered so that they do not blur edges
  double noise = 0;             ///< root mean square of the noise of positions along the normal, model units
  double spacing = 0;           ///< sample spacing s, model units
  std::vector<Border> borders;  ///< in ascending order of (a, b)
};

}  // namespace umtet
