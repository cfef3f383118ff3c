#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"
#include "common/context.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {

/// Distances between the boundary of a mesh and the given triangles, both ways: of vertices and centres of its faces,
/// and of the samples and of corners and centres of those triangles that bound the body with all of themselves. These
/// are cut into pieces of the size of the faces. With size and topology of what both bound.
/// @param surface  of these faces
/// \pre domain.triangles is there. \throw Cancelled
TriangleDistances triangle_distances(const Domain& domain, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, const SurfaceDistance& surface,
                                     const MeshEdge& h, const Context& context);

}  // namespace umtet
