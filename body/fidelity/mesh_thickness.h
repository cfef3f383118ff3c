#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_defects.h"
#include "body/fidelity/mesh_edge.h"
#include "common/context.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The boundary vertices of a mesh, and how thin the body or a gap is there: the distance along the normal to the
/// opposite sheet, inside or outside, up to four edges.
struct VertexThickness {
  std::vector<Vec3> vertices;
  std::vector<double> thickness;  ///< for each vertex, model units
  double least_over_h = 0;        ///< least thickness of a vertex, in the edge length at this vertex
  std::vector<Vec3> thin;         ///< the vertices where the thickness is less than kLeastEdgesAcross edges
};

/// Measures the thickness at the boundary vertices.
/// @param boundary  the boundary vertices of the mesh
/// \throw Cancelled
VertexThickness vertex_thickness(const Domain& domain, const TetMesh& mesh, const std::vector<int>& boundary,
                                 const MeshEdge& h, const Context& context);

/// Points of psi = 0, and the thickness at each, model units.
struct PointThickness {
  std::vector<Vec3> points;
  std::vector<double> thickness;
};

/// Adds the parts of psi = 0 that the mesh has lost to its vertices: psi = 0 may be thin where the mesh has no vertex.
/// \throw Cancelled
PointThickness with_lost_parts(const VertexThickness& vertices, const std::vector<Difference>& lost,
                               const Domain& domain, const MeshEdge& h, const Context& context);

}  // namespace umtet
