#include "reconstruct/triangles/patch_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "reconstruct/triangles/edge_uses.h"
#include "reconstruct/triangles/face_patches.h"

namespace umtet {
namespace {

// Of the size of the coordinates: nearer to the patch than this, the direction from the closest point is rounding.
constexpr double kOnPatch = 1e-12;

double angle_at(const TriangleMesh& mesh, std::size_t f, int k) {
  const Vec3 u = mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k), v = mesh.corner(f, (k + 2) % 3) - mesh.corner(f, k);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

PatchSurface::PatchSurface(TriangleMesh mesh)
    : mesh_(std::move(mesh)),
      tree_(mesh_),
      normal_(mesh_.V.size(), Vec3::Zero()),
      is_border_(mesh_.F.size(), std::array<std::uint8_t, 3>{}),
      is_on_border_(mesh_.V.size(), 0) {
  const std::vector<int> first = welded(mesh_.V, 0);
  for (std::size_t f = 0; f < mesh_.F.size(); ++f) {
    const Vec3 n = mesh_.area_vector(f).normalized();
    for (int k = 0; k < 3; ++k) normal_[first[mesh_.F[f][k]]] += angle_at(mesh_, f, k) * n;
  }
  for (std::size_t v = 0; v < normal_.size(); ++v) normal_[v] = normal_[first[v]].normalized();
  const std::vector<EdgeUse> uses = edge_uses(mesh_, first);
  for_each_edge(uses, [&](std::size_t begin, std::size_t end) {
    if (end - begin == 2) return;
    is_on_border_[uses[begin].low] = is_on_border_[uses[begin].high] = 1;
    for (std::size_t u = begin; u < end; ++u) {
      const Triangle& t = mesh_.F[uses[u].face];
      for (int k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(first[t[k]], first[t[(k + 1) % 3]]);
        if (low == uses[u].low && high == uses[u].high) is_border_[uses[u].face][k] = 1;
      }
    }
  });
  for (std::size_t v = 0; v < is_on_border_.size(); ++v) is_on_border_[v] = is_on_border_[first[v]];
}

double PatchSurface::evaluate(const Vec3& x, Vec3* gradient) const {
  const TriangleHit hit = tree_.nearest(x);
  const Triangle& t = mesh_.F[hit.face];
  Vec3 w;
  closest_on_triangle(x, mesh_.V[t[0]], mesh_.V[t[1]], mesh_.V[t[2]], &w);
  const Vec3 n = (w[0] * normal_[t[0]] + w[1] * normal_[t[1]] + w[2] * normal_[t[2]]).normalized();
  bool is_on_border = false;
  for (int k = 0; k < 3; ++k) {
    is_on_border |= w[(k + 2) % 3] == 0 && is_border_[hit.face][k];
    is_on_border |= w[k] == 1 && is_on_border_[t[k]];
  }
  const Vec3 d = x - hit.point;
  const double along = d.dot(n);
  if (is_on_border || !(hit.distance > kOnPatch * x.norm())) {
    if (gradient) *gradient = n;
    return along;
  }
  const double value = along < 0 ? -hit.distance : hit.distance;
  if (gradient) *gradient = d / value;
  return value;
}

std::vector<TriangleMesh> split_patches(const TriangleMesh& mesh, const SharpEdges& edges) {
  std::vector<TriangleMesh> patches(edges.n_patches);
  std::vector<std::vector<std::size_t>> faces(edges.n_patches);
  for (std::size_t f = 0; f < mesh.F.size(); ++f) faces[edges.patch[f]].push_back(f);
  std::vector<int> number(mesh.V.size(), -1);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    TriangleMesh& patch = patches[p];
    for (const std::size_t f : faces[p]) {
      Triangle t = mesh.F[f];
      for (int& v : t) {
        if (number[v] < 0) {
          number[v] = static_cast<int>(patch.V.size());
          patch.V.push_back(mesh.V[v]);
        }
        v = number[v];
      }
      patch.F.push_back(t);
    }
    for (const std::size_t f : faces[p])
      for (const int v : mesh.F[f]) number[v] = -1;
  }
  return patches;
}

}  // namespace umtet
