#include "mesh/features/feature_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "mesh/core/boundary_strata.h"

namespace umtet {
namespace {

using Edge = std::pair<int, int>;

/// Distance of x from a chain, in h of the nearer end of the nearest edge.
double distance_to_chain(const PiecewiseMesh& made, const std::vector<int>& chain, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity(), h = 1;
  for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
    const Vec3 &a = made.mesh.V[chain[k]], d = made.mesh.V[chain[k + 1]] - a;
    const double t = std::clamp((x - a).dot(d) / d.squaredNorm(), 0., 1.), distance = (x - a - t * d).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    h = made.h[chain[t < .5 ? k : k + 1]];
  }
  return std::sqrt(least) / h;
}

/// Angle inside between two faces with a common edge; `beyond` is the corner of the second face that is not on it.
double inner_angle_deg(const Vec3& on_edge, const Vec3& normal, const Vec3& other_normal, const Vec3& beyond) {
  const double turn = std::atan2(normal.cross(other_normal).norm(), normal.dot(other_normal)) * 180 / std::numbers::pi;
  return (beyond - on_edge).dot(normal) < 0 ? 180 - turn : 180 + turn;
}

}  // namespace

FeatureMeasures measure_features(const PiecewiseDomain& domain, const PiecewiseMesh& made) {
  FeatureMeasures m;
  const std::vector<Vec3>& V = made.mesh.V;
  const BoundaryStrata strata(domain, made.strata);
  std::vector<Vec3> normal;
  std::map<Edge, std::array<int, 2>> faces;  // by edge
  for (std::size_t f = 0; f < made.faces.size(); ++f) {
    const Triangle& t = made.faces[f];
    const Vec3 &a = V[t[0]], &b = V[t[1]], &c = V[t[2]];
    normal.push_back((b - a).cross(c - a).normalized());
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      const auto [at, is_new] = faces.try_emplace({low, high}, std::array{static_cast<int>(f), -1});
      if (!is_new) at->second[1] = static_cast<int>(f);
    }
    if (made.face_patch[f] < 0) {
      ++m.n_faces_without_patch;
      continue;
    }
    Vec3 g;
    strata.value(made.face_patch[f], (a + b + c) / 3, &g);
    m.least_cosine = std::min(m.least_cosine, normal.back().dot(g.normalized()));
  }
  m.n_corners = made.graph.corners.size();
  for (std::size_t c = 0; c < m.n_corners; ++c) {
    const int v = made.corner_vertex[c];
    m.n_missed_corners += v < 0 ? 1 : 0;
    if (v >= 0)
      m.farthest_vertex = std::max(m.farthest_vertex, (V[v] - made.graph.corners[c].place).norm() / made.h[v]);
  }
  m.n_curves = made.graph.curves.size();
  for (std::size_t c = 0; c < m.n_curves; ++c) {
    const FeatureCurve& curve = made.graph.curves[c];
    const std::vector<int>& chain = made.chains[c];
    m.length += curve.length();
    if (chain.empty()) {
      ++m.n_missed_curves;
      m.missed_length += curve.length();
      continue;
    }
    for (const int v : chain)
      m.farthest_vertex = std::max(m.farthest_vertex, strata.distance(made.stratum[v], V[v]) / made.h[v]);
    for (const Vec3& x : curve.points) m.farthest_point = std::max(m.farthest_point, distance_to_chain(made, chain, x));
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
      const auto [low, high] = std::minmax(chain[k], chain[k + 1]);
      const auto at = faces.find({low, high});
      if (at == faces.end() || at->second[1] < 0) {
        m.missed_length += (V[low] - V[high]).norm();
        continue;
      }
      const auto [f, g] = at->second;
      const Triangle& t = made.faces[g];
      const int beyond = *std::find_if(t.begin(), t.end(), [&, a = low, b = high](int v) { return v != a && v != b; });
      const double angle = inner_angle_deg(V[low], normal[f], normal[g], V[beyond]);
      const double of_domain = curve.angle_deg_at(curve.nearest((V[low] + V[high]) / 2).arc);
      m.worst_angle_deg = std::max(m.worst_angle_deg, std::abs(angle - of_domain));
    }
  }
  return m;
}

}  // namespace umtet
