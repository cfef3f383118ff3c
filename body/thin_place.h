#pragma once

#include <Eigen/Geometry>

#include "common/vec3.h"

namespace umtet {

/// A mesh of edge length h shows what is this many edges thick; thinner parts may be missing from it.
inline constexpr double kLeastEdgesAcross = 1.25;

/// A connected place where the body, or the gap outside it, is too thin for a mesh of some edge length. Lengths in
/// model units; places in working coordinates, but for those of in_model().
struct ThinPlace {
  bool is_gap = false;
  Eigen::AlignedBox3d box;     ///< of the points of the boundary that belong to it
  Vec3 centre = Vec3::Zero();  ///< their mean
  double thickness = 0;        ///< the least
  double area = 0;             ///< of the boundary that belongs to it, both sides
  double h_needed = 0;         ///< the largest edge length at which it is not too thin any more
};

}  // namespace umtet
