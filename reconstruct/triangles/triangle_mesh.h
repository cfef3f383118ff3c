#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <vector>

#include "common/vec3.h"

namespace umtet {

using Triangle = std::array<int, 3>;  ///< vertex indices, counter-clockwise seen from outside if the file is correct

/// Triangle soup, as CAD programs and scanners export it: arbitrary triangles, which need not fit together.
struct TriangleMesh {
  std::vector<Vec3> V;           ///< finite; model units
  std::vector<Triangle> F;       ///< indices into V
  std::vector<int> labels = {};  ///< part of the surface that a triangle belongs to; optional
  /// Sides of triangles, indices into V, that are sharp edges whatever their angle; optional.
  std::vector<std::array<int, 2>> lines = {};

  const Vec3& corner(std::size_t f, int k) const { return V[F[f][k]]; }
  Vec3 centroid(std::size_t f) const { return (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3; }
  /// Area times the normal.
  Vec3 area_vector(std::size_t f) const { return (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)) / 2; }
};

}  // namespace umtet
