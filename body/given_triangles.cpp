#include "body/given_triangles.h"

#include <utility>

#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/sliver_repair.h"

namespace umtet {
namespace {

// Of the diagonal: lower triangles have no certain normal. STL files store coordinates with 24 bits.
constexpr double kSliver = 1e-6;

TriangleMesh whole_triangles(const TriangleMesh& mesh) {
  TriangleMesh some;
  std::vector<int> number(mesh.V.size(), -1);
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    if (!mesh.labels.empty() && mesh.labels[f] == 0) continue;
    Triangle t = mesh.F[f];
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(some.V.size());
        some.V.push_back(mesh.V[v]);
      }
      v = number[v];
    }
    some.F.push_back(t);
  }
  return some;
}

}  // namespace

std::shared_ptr<const GivenTriangles> given_triangles(TriangleMesh mesh, const Vec3& shift, double sure_turn) {
  for (Vec3& x : mesh.V) x -= shift;
  SurfaceDistance distance(mesh.V, mesh.F);
  const TriangleBody body = measure_body(mesh);
  TriangleMesh whole = whole_triangles(mesh);
  const bool is_whole = whole.F.size() == mesh.F.size();
  remove_slivers(whole, kSliver * diagonal_of(whole));
  SharpEdges edges = find_sharp_edges(whole, {.sure_turn = sure_turn});
  return std::make_shared<const GivenTriangles>(
      GivenTriangles{std::move(mesh), std::move(distance), std::move(whole), is_whole, std::move(edges), body});
}

}  // namespace umtet
