#include "body/given_triangles.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "reconstruct/triangles/body_samples.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/feature_lines.h"
#include "reconstruct/triangles/sliver_repair.h"

namespace umtet {
namespace {

// Of the diagonal: lower triangles have no certain normal. STL files store coordinates with 24 bits.
constexpr double kSliver = 1e-6;

// Samples of a closed surface may be taken to be inside where the winding number is not exact, as in a narrow groove.
// Where bodies overlap, or have inner walls, there are several pieces, and more of the area is inside.
constexpr double kFewInside = .01;

/// Returns whether at most a small share of the area is on triangles that are partly inside.
bool is_on_boundary(const TriangleMesh& mesh) {
  double all = 0, inside = 0;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    const double area = mesh.area_vector(f).norm();
    all += area;
    if (!mesh.labels.empty() && is_partly_inside(mesh.labels[f])) inside += area;
  }
  return inside <= kFewInside * all;
}

/// The triangles that are not partly inside, or all, with the vertices that they use and their groups.
TriangleMesh whole_triangles(const TriangleMesh& mesh, bool all) {
  TriangleMesh some;
  std::vector<int> number(mesh.V.size(), -1);
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    const int label = mesh.labels.empty() ? 1 : mesh.labels[f];
    if (!all && is_partly_inside(label)) continue;
    Triangle t = mesh.F[f];
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(some.V.size());
        some.V.push_back(mesh.V[v]);
      }
      v = number[v];
    }
    some.F.push_back(t);
    some.labels.push_back(group_of(label));
  }
  const std::vector<int>& groups = some.labels;
  if (std::adjacent_find(groups.begin(), groups.end(), std::not_equal_to<>()) == groups.end()) some.labels.clear();
  some.lines = renumbered_lines(mesh.lines, number);
  return some;
}

}  // namespace

std::shared_ptr<const GivenTriangles> given_triangles(TriangleMesh mesh, const Vec3& shift,
                                                      const SharpEdgeParams& params) {
  for (Vec3& x : mesh.V) x -= shift;
  SurfaceDistance distance(mesh.V, mesh.F);
  const TriangleBody of_all = measure_body({mesh.V, mesh.F});
  const bool is_on = is_on_boundary(mesh) || (of_all.n_pieces == 1 && of_all.is_manifold);
  const TriangleBody body = is_on ? of_all : measure_body(mesh);
  const bool is_whole = is_on && body.is_closed && body.is_manifold;
  TriangleMesh whole = whole_triangles(mesh, is_whole);
  remove_slivers(whole, kSliver * diagonal_of(whole));
  SharpEdges edges = find_sharp_edges(whole, params);
  return std::make_shared<const GivenTriangles>(
      GivenTriangles{std::move(mesh), std::move(distance), std::move(whole), is_whole, std::move(edges), body});
}

}  // namespace umtet
