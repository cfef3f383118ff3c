#pragma once

#include <Eigen/Geometry>

#include "common/vec3.h"

namespace umtet {

/// A mesh resolves parts of this thickness, in edge lengths; thinner parts may be missing from it.
inline constexpr double kLeastEdgesAcross = 1.25;

/// A connected region in which the body, or the gap outside it, is too thin for a mesh of some edge length. Lengths are
/// in model units, positions in working coordinates (in_model() converts them to model coordinates).
struct ThinPlace {
  bool is_gap = false;
  Eigen::AlignedBox3d box;     ///< box of the points of psi = 0 in the region
  Vec3 centre = Vec3::Zero();  ///< mean of these points
  double thickness = 0;        ///< least thickness
  double area = 0;             ///< area of psi = 0 in the region, on both sides
  double h_needed = 0;         ///< largest edge length for which the region is not too thin
};

}  // namespace umtet
