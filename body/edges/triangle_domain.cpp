#include "body/edges/triangle_domain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "reconstruct/triangles/edge_uses.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/patch_primitive.h"
#include "reconstruct/triangles/patch_surface.h"
#include "reconstruct/triangles/triangle_tree.h"

namespace umtet {
namespace {

// Largest distance of a vertex from its surface, as a share of the diagonal. STL files store coordinates with 24 bits:
// 6e-8 of their size.
constexpr double kVertexTolerance = 1e-6;
// Largest distance of a facet from it, as a share of the diagonal: half of the default deviation of mesh faces.
constexpr double kFacetTolerance = 2.5e-4;
// Points of a curve for each of its edges in the file, where it is the common zero set of two such surfaces.
constexpr int kPointsAnEdge = 4;
// Cosine of the least angle between the normals of two surfaces that define their curve: 15 degrees.
constexpr double kMostCos = .966;
// Degrees: edges that turn by less are lines in a smooth surface. STL files in single precision turn by less.
constexpr double kFlat = 1;
constexpr int kMostNewton = 20;
constexpr double kConverged = 1e-13;  // of the coordinates
constexpr int kParts = 3;             // of a curve that returns to its corner

/// A sharp edge and what is on its sides.
struct SharpSide {
  std::array<int, 2> patches;  ///< ascending
  double angle_deg;            ///< of the body, in (0, 360)
};
using SharpSides = std::map<std::pair<int, int>, SharpSide>;  // by welded vertices

/// Patches and edges around the triangles of a surface.
class Surface {
 public:
  Surface(const TriangleMesh& mesh, const SharpEdges& edges)
      : mesh_(mesh), tree_(mesh), first_(welded(mesh.V, find_patches(mesh).weld_distance)), patch_(mesh.F.size()) {
    for (std::size_t f = 0; f < patch_.size(); ++f) patch_[f] = static_cast<int>(edges.patch[f]);
    for (const SharpCurve& c : edges.curves)
      for (std::size_t k = 0; k + 1 < c.vertices.size(); ++k) sharp_[edge_of(c.vertices[k], c.vertices[k + 1])] = {};
    farthest_ = 2 * kFacetTolerance * diagonal_of(mesh);
    side_.assign(mesh.F.size(), {});
    at_.resize(mesh.V.size());
    measure_edges();
    measure_vertices();
    for (TriangleMesh& patch : split_patches(mesh, edges)) patches_.push_back(function_of(std::move(patch)));
  }

  bool is_closed() const { return is_closed_; }
  const std::vector<PatchFunction>& patches() const { return patches_; }
  const std::vector<double>& curvature() const { return curvature_; }
  const SharpSide& side(int a, int b) const { return sharp_.at(edge_of(a, b)); }
  const std::vector<int>& patches_at(int vertex) const { return at_[first_[vertex]].patches; }
  ActivePatch psi(const Vec3& x) const;
  /// Moves x to the common zero of two patches, by the shortest steps. \return whether there is one near x, and one of
  /// the patches is exact
  bool correct(const std::array<int, 2>& pair, Vec3& x) const;

 private:
  struct AroundVertex {
    Vec3 normal = Vec3::Zero();
    std::vector<int> patches;  ///< ascending
    bool is_on_curve = false;
  };
  std::pair<int, int> edge_of(int a, int b) const { return std::minmax(first_[a], first_[b]); }
  void measure_edges();
  void measure_vertices();
  PatchFunction function_of(TriangleMesh patch);
  ActivePatch at_vertex(const Vec3& x, int v) const;

  TriangleMesh mesh_;
  TriangleTree tree_;
  std::vector<int> first_;  ///< per vertex: the one that it is welded to
  std::vector<int> patch_;  ///< per triangle
  SharpSides sharp_;
  std::vector<std::array<const SharpSide*, 3>> side_;  ///< per triangle: from corner k to k + 1; null where smooth
  std::vector<AroundVertex> at_;                       ///< per welded vertex
  std::vector<PatchFunction> patches_;
  std::vector<double> curvature_;       ///< per patch, as TriangleDomain::curvature
  std::vector<std::uint8_t> is_exact_;  ///< per patch: a plane, sphere, cylinder or cone
  double farthest_ = 0;                 ///< of points of the file from the common zeros of exact patches, model units
  bool is_closed_ = true;
};

void Surface::measure_edges() {
  const std::vector<EdgeUse> uses = edge_uses(mesh_, first_);
  for_each_edge(uses, [&](std::size_t begin, std::size_t end) {
    const EdgeUse &one = uses[begin], &two = uses[end - 1];
    if (end - begin != 2 || one.forward == two.forward) {
      is_closed_ = false;
      return;
    }
    const auto at = sharp_.find({one.low, one.high});
    if (at == sharp_.end()) return;
    const auto [p, q] = std::minmax(patch_[one.face], patch_[two.face]);
    const Vec3 m = mesh_.area_vector(one.face).normalized(), n = mesh_.area_vector(two.face).normalized();
    const double turn = std::atan2(m.cross(n).norm(), m.dot(n)) * 180 / std::numbers::pi;
    const bool is_convex = m.dot(mesh_.centroid(two.face) - mesh_.V[one.low]) < 0;
    at->second = {{p, q}, is_convex ? 180 - turn : 180 + turn};
  });
  for (std::size_t f = 0; f < mesh_.F.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto at = sharp_.find(edge_of(mesh_.F[f][k], mesh_.F[f][(k + 1) % 3]));
      side_[f][k] = at == sharp_.end() ? nullptr : &at->second;
    }
  }
}

void Surface::measure_vertices() {
  for (std::size_t f = 0; f < mesh_.F.size(); ++f) {
    const Vec3 n = mesh_.area_vector(f).normalized();
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = mesh_.corner(f, (k + 1) % 3) - mesh_.corner(f, k),
                 v = mesh_.corner(f, (k + 2) % 3) - mesh_.corner(f, k);
      AroundVertex& around = at_[first_[mesh_.F[f][k]]];
      around.normal += std::atan2(u.cross(v).norm(), u.dot(v)) * n;
      around.patches.push_back(patch_[f]);
    }
  }
  for (AroundVertex& around : at_) {
    std::sort(around.patches.begin(), around.patches.end());
    around.patches.erase(std::unique(around.patches.begin(), around.patches.end()), around.patches.end());
  }
  for (const auto& [edge, side] : sharp_) at_[edge.first].is_on_curve = at_[edge.second].is_on_curve = true;
}

PatchFunction Surface::function_of(TriangleMesh patch) {
  const double diagonal = diagonal_of(mesh_);
  const auto primitive = fit_primitive(patch, {kVertexTolerance * diagonal, kFacetTolerance * diagonal});
  is_exact_.push_back(primitive ? 1 : 0);
  const bool is_plane = primitive && primitive->kind == PatchPrimitive::Kind::Plane;
  curvature_.push_back(is_plane ? 0 : primitive && primitive->radius > 0 ? 1 / primitive->radius : -1);
  if (primitive) return [p = *primitive](const Vec3& x, Vec3* g, Mat3* H) { return p.evaluate(x, g, H); };
  return [surface = std::make_shared<const PatchSurface>(std::move(patch))](const Vec3& x, Vec3* g, Mat3* H) {
    if (H) H->setZero();
    return surface->evaluate(x, g);
  };
}

ActivePatch Surface::at_vertex(const Vec3& x, int v) const {
  const AroundVertex& around = at_[first_[v]];
  const Vec3 d = x - mesh_.V[v];
  const double sign = d.dot(around.normal) < 0 ? -1 : 1;
  // The patch that says so most clearly.
  ActivePatch best{-std::numeric_limits<double>::infinity(), around.patches.front()};
  for (const int p : around.patches) {
    const double f = sign * patches_[p](x, nullptr, nullptr);
    if (f > best.value) best = {f, p};
  }
  return {sign * d.norm(), best.patch};
}

ActivePatch Surface::psi(const Vec3& x) const {
  const TriangleHit hit = tree_.nearest(x);
  const Triangle& t = mesh_.F[hit.face];
  Vec3 w;
  closest_on_triangle(x, mesh_.V[t[0]], mesh_.V[t[1]], mesh_.V[t[2]], &w);
  for (int k = 0; k < 3; ++k)
    if (w[k] == 1 && at_[first_[t[k]]].is_on_curve) return at_vertex(x, t[k]);
  for (int k = 0; k < 3; ++k) {
    const SharpSide* side = side_[hit.face][k];
    if (!side || w[(k + 2) % 3] != 0) continue;
    const auto [p, q] = side->patches;
    const bool is_convex = side->angle_deg < 180;
    if (p != q) {
      const double f = patches_[p](x, nullptr, nullptr), g = patches_[q](x, nullptr, nullptr);
      return (f < g) == is_convex ? ActivePatch{g, q} : ActivePatch{f, p};
    }
    if (std::abs(side->angle_deg - 180) < kFlat) break;  // a line in a smooth patch
    // Both sides of the crease are one patch: x is beyond a convex edge outside, beyond a concave one inside.
    return {is_convex ? hit.distance : -hit.distance, p};
  }
  const int p = patch_[hit.face];
  return {patches_[p](x, nullptr, nullptr), p};
}

bool Surface::correct(const std::array<int, 2>& pair, Vec3& x) const {
  const auto [p, q] = pair;
  if (p == q || (!is_exact_[p] && !is_exact_[q])) return false;
  const Vec3 start = x;
  for (int k = 0; k < kMostNewton; ++k) {
    Vec3 a, b;
    const double f = patches_[p](x, &a, nullptr), g = patches_[q](x, &b, nullptr), c = a.dot(b), det = 1 - c * c;
    if (!(std::abs(c) < kMostCos)) return false;
    const Vec3 step = (c * g - f) / det * a + (c * f - g) / det * b;
    x += step;
    if ((x - start).norm() > farthest_) return false;
    if (step.norm() <= kConverged * (x.norm() + farthest_)) return true;
  }
  return false;
}

/// A curve of the file with its corners.
class GraphMaker {
 public:
  GraphMaker(const TriangleMesh& mesh, const SharpEdges& edges, const Surface& surface)
      : mesh_(mesh), surface_(surface) {
    for (const int v : edges.corners) corner(v);
    for (const SharpCurve& c : edges.curves) {
      const bool is_loop = c.is_closed() && corner_.contains(c.vertices.front());
      const std::size_t n_edges = c.vertices.size() - 1, n_parts = is_loop ? kParts : 1;
      for (std::size_t k = 0; k < n_parts; ++k) {
        const auto from = static_cast<std::ptrdiff_t>(k * n_edges / n_parts),
                   to = static_cast<std::ptrdiff_t>((k + 1) * n_edges / n_parts);
        add({c.vertices.begin() + from, c.vertices.begin() + to + 1}, is_loop || !c.is_closed());
      }
    }
  }
  FeatureGraph graph() { return std::move(graph_); }

 private:
  int corner(int v) {
    const auto [at, is_new] = corner_.try_emplace(v, static_cast<int>(graph_.corners.size()));
    if (is_new) graph_.corners.push_back({mesh_.V[v], surface_.patches_at(v)});
    return at->second;
  }

  void add(const std::vector<int>& vertices, bool has_ends) {
    FeatureCurve curve;
    curve.is_given = true;
    curve.patches = surface_.side(vertices[0], vertices[1]).patches;
    if (has_ends) curve.ends = {corner(vertices.front()), corner(vertices.back())};
    const std::size_t n = vertices.size() - 1;
    std::vector<double> angle;
    for (std::size_t k = 0; k < n; ++k) angle.push_back(surface_.side(vertices[k], vertices[k + 1]).angle_deg);
    curve.arc = {0};
    for (std::size_t k = 0; k <= n; ++k) {
      curve.points.push_back(mesh_.V[vertices[k]]);
      if (k > 0) curve.arc.push_back(curve.arc.back() + (curve.points[k] - curve.points[k - 1]).norm());
      const std::size_t before = k > 0 ? k - 1 : has_ends ? 0 : n - 1, after = k < n ? k : has_ends ? n - 1 : 0;
      curve.angle_deg.push_back((angle[before] + angle[after]) / 2);
    }
    refine(curve);
    graph_.curves.push_back(std::move(curve));
  }

  /// The common zero set of two patches, if one is exact: the points of the file, which are on chords, and more between
  /// them.
  void refine(FeatureCurve& curve) const {
    FeatureCurve fine = curve;
    fine.is_given = false;
    fine.points.clear(), fine.arc.clear(), fine.angle_deg.clear();
    const std::size_t n = (curve.points.size() - 1) * kPointsAnEdge;
    for (std::size_t k = 0; k <= n; ++k) {
      const std::size_t i = std::min(k / kPointsAnEdge, curve.points.size() - 2);
      const double t = static_cast<double>(k - i * kPointsAnEdge) / kPointsAnEdge;
      Vec3 x = (1 - t) * curve.points[i] + t * curve.points[i + 1];
      const bool is_end = k == 0 || k == n;
      if (!(is_end && !curve.is_closed()) && !surface_.correct(curve.patches, x)) return;
      fine.arc.push_back(fine.points.empty() ? 0 : fine.arc.back() + (x - fine.points.back()).norm());
      fine.points.push_back(x);
      fine.angle_deg.push_back((1 - t) * curve.angle_deg[i] + t * curve.angle_deg[i + 1]);
    }
    if (curve.is_closed()) fine.points.back() = fine.points.front();
    curve = std::move(fine);
  }

  const TriangleMesh& mesh_;
  const Surface& surface_;
  std::map<int, int> corner_;  ///< by vertex
  FeatureGraph graph_;
};

}  // namespace

std::optional<TriangleDomain> triangle_domain(const TriangleMesh& mesh, const SharpEdges& edges) {
  const auto surface = std::make_shared<const Surface>(mesh, edges);
  if (!surface->is_closed()) return std::nullopt;
  FeatureGraph graph = GraphMaker(mesh, edges, *surface).graph();
  return TriangleDomain{
      PiecewiseDomain::of_patches(surface->patches(), [surface](const Vec3& x) { return surface->psi(x); }),
      std::move(graph), surface->curvature(), kVertexTolerance * diagonal_of(mesh)};
}

}  // namespace umtet
