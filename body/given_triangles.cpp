#include "body/given_triangles.h"

#include <utility>

namespace umtet {

std::shared_ptr<const GivenTriangles> given_triangles(TriangleMesh mesh, const Vec3& shift) {
  for (Vec3& x : mesh.V) x -= shift;
  SurfaceDistance distance(mesh.V, mesh.F);
  const TriangleBody body = measure_body(mesh);
  return std::make_shared<const GivenTriangles>(GivenTriangles{std::move(mesh), std::move(distance), body});
}

}  // namespace umtet
