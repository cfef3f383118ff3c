#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "mesh/background/background_mesh.h"

namespace umtet::thin_bodies {

/// A body that is thin, or has a gap that is, and what is known of it; lengths in h.
struct Body {
  std::string family;
  double thickness;           ///< of the plate, the blade's middle, the rod, the cone's middle, or the gap
  std::string formula;        ///< of x, y, z; negative inside
  Box box;                    ///< with room for a background
  int n_pieces;               ///< each of them a ball
  std::vector<Vec3> surface;  ///< points of {psi = 0}
};

/// Plates, blades that end in a wedge, rods, cones to a point, balls that nearly touch, slabs with a gap between them.
const std::vector<std::string>& families();

/// @param seed  of thickness (within the bounds), place and rotation
Body random_body(const std::string& family, double least_thickness, double most_thickness, std::uint64_t seed);

}  // namespace umtet::thin_bodies
