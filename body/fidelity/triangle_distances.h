#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"
#include "common/context.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// A sharp edge is rounded where the boundary is farther from it than this, in h. Flat faces of size h are as far from
/// a curve of radius 1.25 h.
inline constexpr double kRounded = .1;

/// Measures the distances between the boundary of a mesh and the triangles of the input in both directions: from the
/// vertices and centres of the boundary faces, and from the samples and from the corners and centres of the triangles
/// that lie completely on the boundary of the body. These triangles are first cut into pieces of the size of the
/// boundary faces. The result also contains the size and topology of the bodies that the mesh and the triangles bound.
/// @param surface  distance to these faces
/// \pre domain.triangles is set. \throw Cancelled
TriangleDistances triangle_distances(const Domain& domain, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, const SurfaceDistance& surface,
                                     const MeshEdge& h, const Context& context);

}  // namespace umtet
