#include "body/fidelity/triangle_distances.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/quality_report.h"
#include "reconstruct/triangles/cut_triangles.h"

namespace umtet {
namespace {

// Pieces of large triangles are not more than so many times the triangles and faces, and some.
constexpr std::size_t kPieces = 4, kPiecesAnyway = 100000;

struct Spread {
  double rms = 0, p99 = 0, max = 0, max_over_h = 0;
  Vec3 farthest = Vec3::Zero();
};

Spread spread_of(const std::vector<Vec3>& x, std::vector<double> d, const MeshEdge& h) {
  const auto farthest = std::max_element(d.begin(), d.end()) - d.begin();
  Spread s{.max = d[farthest], .max_over_h = d[farthest] / h.at(x[farthest]), .farthest = x[farthest]};
  for (std::size_t i = 0; i < d.size() && !h.is_uniform(); ++i) {
    if (d[i] > s.max_over_h * h.least()) s.max_over_h = std::max(s.max_over_h, d[i] / h.at(x[i]));
  }
  std::sort(d.begin(), d.end());
  s.rms = std::sqrt(std::transform_reduce(d.begin(), d.end(), 0., std::plus<>(), [](double v) { return v * v; }) /
                    static_cast<double>(d.size()));
  s.p99 = quantile(d, .99);
  return s;
}

/// Of a boundary without corners that are at one place.
TriangleBody body_of(const std::vector<Vec3>& V, const std::vector<Triangle>& faces) {
  const SurfaceTopology surface = surface_topology(V, faces);
  TriangleBody body{.area = surface.area,
                    .n_pieces = surface.components.size(),
                    .euler_characteristic = surface.euler_characteristic,
                    .is_closed = surface.closed_manifold,
                    .is_manifold = surface.closed_manifold};
  for (const SurfaceComponent& piece : surface.components) body.volume += piece.volume;
  return body;
}

/// Those of which no part is inside of the body, with their vertices.
TriangleMesh whole(const TriangleMesh& mesh) {
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

TriangleDistances triangle_distances(const Domain& domain, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, const SurfaceDistance& surface,
                                     const MeshEdge& h, const Context& context) {
  const GivenTriangles& given = *domain.triangles;
  std::vector<std::uint8_t> is_used(V.size(), 0);
  std::vector<Vec3> x;
  double edge2_sum = 0;
  for (const Triangle& f : faces) {
    x.push_back((V[f[0]] + V[f[1]] + V[f[2]]) / 3);
    edge2_sum += (V[f[0]] - V[f[1]]).squaredNorm();
    for (const int v : f) is_used[v] = 1;
  }
  for (std::size_t v = 0; v < V.size(); ++v)
    if (is_used[v]) x.push_back(V[v]);
  const Spread there = spread_of(x, given.distance.distances(x, context), h);

  // Pieces not larger than the faces.
  const double edge2 = edge2_sum / static_cast<double>(faces.size());
  const TriangleMesh pieces =
      cut_triangles(whole(given.mesh), std::sqrt(edge2), kPieces * (given.mesh.F.size() + faces.size()) + kPiecesAnyway)
          .mesh;
  std::vector<Vec3> y = domain.cloud.points;
  y.insert(y.end(), pieces.V.begin(), pieces.V.end());
  for (std::size_t f = 0; f < pieces.F.size(); ++f) y.push_back(pieces.centroid(f));
  const Spread back = spread_of(y, surface.distances(y, context), h);
  return {.n_triangles = given.mesh.F.size(),
          .rms = there.rms,
          .p99 = there.p99,
          .max = there.max,
          .max_over_h = there.max_over_h,
          .farthest = there.farthest + domain.shift,
          .rms_back = back.rms,
          .p99_back = back.p99,
          .max_back = back.max,
          .max_back_over_h = back.max_over_h,
          .farthest_back = back.farthest + domain.shift,
          .body = given.body,
          .mesh = body_of(V, faces)};
}

}  // namespace umtet
