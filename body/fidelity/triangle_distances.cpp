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
constexpr double kPointsAnEdge = 10000;

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

/// Measures the vertices of the curves, and points between them that are at most h apart and share the length.
SharpEdgeReport edge_report(const GivenTriangles& given, const SurfaceDistance& surface, const MeshEdge& h,
                            const Context& context) {
  const SharpEdges& edges = given.edges;
  SharpEdgeReport report{
      .n_curves = edges.curves.size(), .n_corners = edges.corners.size(), .n_patches = edges.n_patches};
  std::vector<Vec3> x;
  std::vector<double> length;
  for (const SharpCurve& curve : edges.curves) {
    report.length += curve.length;
    for (std::size_t k = 1; k < curve.vertices.size(); ++k) {
      const Vec3 &a = given.whole.V[curve.vertices[k - 1]], &b = given.whole.V[curve.vertices[k]];
      const int n = static_cast<int>(std::clamp(std::ceil((b - a).norm() / h.nominal()), 1., kPointsAnEdge));
      for (int i = 0; i < n; ++i) {
        x.push_back(a + (i + .5) / n * (b - a));
        length.push_back((b - a).norm() / n);
      }
      x.insert(x.end(), {a, b});
      length.insert(length.end(), {0, 0});
    }
  }
  const std::vector<double> d = surface.distances(x, context), h_at = h.at(x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (d[i] > kRounded * h_at[i]) report.rounded_length += length[i];
    if (d[i] <= report.max_over_h * h_at[i]) continue;
    report.max_over_h = d[i] / h_at[i];
    report.farthest = x[i];
  }
  return report;
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
      cut_triangles(given.whole, std::sqrt(edge2), kPieces * (given.mesh.F.size() + faces.size()) + kPiecesAnyway).mesh;
  std::vector<Vec3> y = domain.cloud.points;
  y.insert(y.end(), pieces.V.begin(), pieces.V.end());
  for (std::size_t f = 0; f < pieces.F.size(); ++f) y.push_back(pieces.centroid(f));
  const Spread back = spread_of(y, surface.distances(y, context), h);
  TriangleDistances made{.n_triangles = given.mesh.F.size(),
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
  if (!given.edges.curves.empty()) {
    made.edges = edge_report(given, surface, h, context);
    made.edges->farthest += domain.shift;
  }
  return made;
}

}  // namespace umtet
