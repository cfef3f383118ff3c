#pragma once

#include <memory>
#include <vector>

#include "common/context.h"
#include "mesh/implicit/surface_distance.h"
#include "body/fidelity/mesh_edge.h"
#include "pipeline/reports/certificate_report.h"
#include "reconstruct/triangles/triangle_body.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

struct Domain;

/// The triangles that a user gave and that bound the body, in working coordinates; of those with label 0 a part is
/// inside.
struct GivenTriangles {
  TriangleMesh mesh;
  SurfaceDistance distance;
  TriangleBody body;  ///< what they bound
};

/// @param shift  taken off their coordinates
/// \throw std::invalid_argument  no triangles
std::shared_ptr<const GivenTriangles> given_triangles(TriangleMesh mesh, const Vec3& shift);

/// Distances between the boundary of a mesh and the given triangles, both ways: of vertices and centres of its faces,
/// and of the samples and of corners and centres of those triangles that bound the body with all of themselves. These
/// are cut into pieces of the size of the faces. With size and topology of what both bound.
/// @param surface  of these faces
/// \pre domain.triangles is there. \throw Cancelled
TriangleDistances triangle_distances(const Domain& domain, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, const SurfaceDistance& surface,
                                     const MeshEdge& h, const Context& context);

}  // namespace umtet
