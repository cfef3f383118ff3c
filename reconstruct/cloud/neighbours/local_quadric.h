#pragma once

#include <span>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {

/// Local quadric: the surface near a point as a graph of degree two over the plane of its neighbours.
struct LocalQuadric {
  Vec3 normal = Vec3::Zero();  ///< unit normal of the graph at the point; its sign is arbitrary
  double variance = 0;  ///< variance of the neighbours' distances from the graph, corrected for the six coefficients
};

inline constexpr std::size_t kQuadricCoefficients = 6;

/// Fits a local quadric by least squares, in coordinates centred on the point and scaled by the neighbourhood, so that
/// neither the unit nor the distance from the origin costs digits.
///
/// Curvature turns a fitted plane if more neighbours lie on one side of the point, but not the graph. With noise both
/// have the same error, because slope and curvature do not mix around the centre. The plane's normal is returned if the
/// neighbours do not determine a graph (fewer than seven, or nearly on a conic).
///
/// @param near  neighbours of the point, with or without itself; if all are at one position the normal is zero
/// Does not allocate.
LocalQuadric local_quadric(const std::vector<Vec3>& points, const Vec3& x, std::span<const Neighbour> near);

}  // namespace umtet
