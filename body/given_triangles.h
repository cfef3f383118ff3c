#pragma once

#include <memory>
#include <vector>

#include "mesh/implicit/surface_distance.h"
#include "reconstruct/triangles/triangle_body.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Samples of triangles along an edge of a given h: what a mesh of such edges can show.
inline constexpr double kSamplesAnEdge = 2.5;

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

}  // namespace umtet
