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

/// The triangles of the user that bound the body, in working coordinates.
struct GivenTriangles {
  TriangleMesh mesh;  ///< with the labels of BodySamples::boundary
  SurfaceDistance distance;
  /// The triangles that are not partly inside, with their vertices and without slivers. Labels are the groups of the
  /// triangles, if there are several.
  TriangleMesh whole;
  bool is_whole;      ///< all triangles bound the body: `whole` is a closed manifold
  SharpEdges edges;   ///< sharp edges of `whole`
  TriangleBody body;  ///< the body that they bound
};

/// @param mesh   BodySamples::boundary
/// @param shift  vector that is subtracted from the coordinates
/// \throw std::invalid_argument  no triangles
std::shared_ptr<const GivenTriangles> given_triangles(TriangleMesh mesh, const Vec3& shift,
                                                      const SharpEdgeParams& params = {});

}  // namespace umtet
