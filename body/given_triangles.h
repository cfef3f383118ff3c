#pragma once

#include <memory>
#include <vector>

#include "mesh/implicit/surface_distance.h"
#include "reconstruct/triangles/sharp_edges.h"
#include "reconstruct/triangles/triangle_body.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Number of samples of triangles per edge length h, if h is given: more samples show detail that such a mesh cannot
/// resolve.
inline constexpr double kSamplesAnEdge = 2.5;

/// The triangles of the user that bound the body, in working coordinates. Triangles with label 0 are partly inside the
/// body.
struct GivenTriangles {
  TriangleMesh mesh;
  SurfaceDistance distance;
  TriangleMesh whole;  ///< the triangles that are not partly inside, with their vertices and without slivers
  bool is_whole;       ///< no triangle is partly inside
  SharpEdges edges;    ///< of `whole`
  TriangleBody body;   ///< the body that they bound
};

/// @param shift      vector that is subtracted from the coordinates
/// @param sure_turn  SharpEdgeParams::sure_turn, degrees
/// \throw std::invalid_argument  no triangles
std::shared_ptr<const GivenTriangles> given_triangles(TriangleMesh mesh, const Vec3& shift,
                                                      double sure_turn = SharpEdgeParams().sure_turn);

}  // namespace umtet
