#pragma once

#include <span>

#include "reconstruct/cloud/neighbour_tree.h"

namespace umtet {

/// The surface near a point as a graph of degree two over the plane of its neighbours.
struct LocalQuadric {
  Vec3 normal = Vec3::Zero();  ///< unit, of the graph over the point; its sign means nothing
  double variance = 0;         ///< of the neighbours' heights about the graph, corrected for the six coefficients
};

inline constexpr std::size_t kQuadricCoefficients = 6;

/// Least squares in coordinates centred on the point and scaled by the neighbourhood, so that neither the unit nor the
/// distance from the origin costs digits.
///
/// A plane alone is turned by curvature where the neighbours lie more to one side of the point; the graph is not. With
/// noise both have the same error, because slope and curvature do not mix around the middle. The plane's normal is the
/// answer where the neighbours do not fix a graph (fewer than seven, or nearly on a conic).
///
/// @param near  neighbours of the point, itself among them or not; all on one place give a zero normal
/// Does not allocate.
LocalQuadric local_quadric(const std::vector<Vec3>& points, const Vec3& x, std::span<const Neighbour> near);

}  // namespace umtet
