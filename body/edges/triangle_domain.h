#pragma once

#include <optional>
#include <vector>

#include "mesh/core/piecewise_domain.h"
#include "mesh/features/feature_graph.h"
#include "reconstruct/triangles/sharp_edges.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// A piecewise smooth domain with its curves and corners.
struct TriangleDomain {
  PiecewiseDomain domain;
  FeatureGraph graph;
  /// Largest curvature of each patch that is a plane, sphere or cylinder, 1 / model units; -1 for others.
  std::vector<double> curvature;
  double tolerance;  ///< distance within which the curves and corners lie on their patches, model units
};

/// The domain inside of some triangles, with one function for each smooth patch.
///
/// A patch whose vertices lie on a plane, sphere, cylinder or cone within 1e-6 of the diagonal, and its facets within
/// 2.5e-4, is that surface (patch_primitive.h); any other patch is its triangles (patch_surface.h). psi(x) is the
/// function of the patch of the triangle nearest to x. Where the nearest point is on a sharp edge, psi is the maximum
/// of the functions of its two patches if the edge is convex, else the minimum; where it is a vertex of a curve, psi is
/// the distance from it, with the sign of the angle-weighted normal of all triangles around [Baerentzen2005].
///
/// Curves are the polylines of `edges`. Where two patches meet at 15 degrees or more, and one of them is a plane,
/// sphere, cylinder or cone, the curve is their common zero set. Curves that return to a corner are divided in three.
/// @param mesh   triangles that face outward
/// @param edges  find_sharp_edges() of these triangles
/// @return none if the surface is no closed manifold: each edge has two triangles, in opposite directions
std::optional<TriangleDomain> triangle_domain(const TriangleMesh& mesh, const SharpEdges& edges);

}  // namespace umtet
