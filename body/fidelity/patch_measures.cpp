#include "body/fidelity/patch_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "body/piecewise_body.h"
#include "body/sizing/edge_length.h"
#include "common/polled_loops.h"
#include "mesh/certify/surface_measures.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// In h: what the file of a mesh leaves of the distance of a vertex to its patch.
constexpr double kOnPatch = 1e-6;

// Two patches continue each other where the cosine of their normals is greater than 1 minus this: 3 degrees.
constexpr double kAlike = 1e-3;

/// One patch, negative inside, as an implicit function; psi as a whole for -1.
struct Patch {
  const PiecewiseDomain* body;
  int number;
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
    if (number < 0) return body->evaluate(x, gradient, hessian);
    const double side = body->side(number), value = body->patch(number, x, gradient, hessian);
    if (gradient) *gradient *= side;
    if (hessian) *hessian *= side;
    return side * value;
  }
};

}  // namespace

std::vector<int> patches_by_position(const PiecewiseDomain& body, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, double tolerance, const Context& context) {
  std::vector<int> boundary;
  for (const Triangle& f : faces) boundary.insert(boundary.end(), f.begin(), f.end());
  std::sort(boundary.begin(), boundary.end());
  boundary.erase(std::unique(boundary.begin(), boundary.end()), boundary.end());
  std::vector<std::vector<int>> at(V.size());
  polled_parallel_for(boundary.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const int v = boundary[i];
    for (int p = 0; p < body.n_patches(); ++p) {
      if (vertex_distance(Patch{&body, p}, V[v]) <= tolerance) at[v].push_back(p);
    }
  });
  std::vector<int> patch(faces.size(), -1);
  polled_parallel_for(faces.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const auto& [a, b, c] = faces[i];
    const Vec3 n = (V[b] - V[a]).cross(V[c] - V[a]).stableNormalized(), centroid = (V[a] + V[b] + V[c]) / 3;
    double nearest = -std::numeric_limits<double>::infinity();
    std::vector<std::pair<int, double>> candidates;
    for (const int p : at[a]) {
      const auto has = [p](const std::vector<int>& all) { return std::binary_search(all.begin(), all.end(), p); };
      if (!has(at[b]) || !has(at[c])) continue;
      Vec3 g;
      Patch{&body, p}.evaluate(centroid, &g, nullptr);
      const double cosine = n.dot(g.normalized());
      candidates.emplace_back(p, cosine);
      if (cosine > nearest) nearest = cosine, patch[i] = p;
    }
    // Patches of one plane differ in their borders only.
    if (candidates.size() < 2 || body.decides_by_signs()) return;
    const int active = body.active(centroid);
    for (const auto& [p, cosine] : candidates)
      if (p == active && cosine > nearest - kAlike) patch[i] = p;
  });
  return patch;
}

std::vector<int> patches_by_position(const Domain& domain, const std::vector<Vec3>& V,
                                     const std::vector<Triangle>& faces, double h, const Context& context) {
  return patches_by_position(domain.piecewise->domain, V, faces,
                             kOnPatch * h + coordinate_rounding(domain) + domain.piecewise->tolerance, context);
}

void measure_against_patches(const PiecewiseBody& of, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                             const std::vector<int>& patch, const Context& context, MeshCertificate& certificate) {
  const PiecewiseDomain& body = of.domain;
  std::vector<std::pair<int, int>> vertices;  // and a patch
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const int v : faces[f]) vertices.emplace_back(v, patch[f]);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<double> distance(vertices.size());
  polled_parallel_for(vertices.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const auto [v, p] = vertices[i];
    distance[i] = vertex_distance(Patch{&body, p}, V[v]);
  });
  const double h = certificate.h;
  std::vector<FaceMeasure> face(faces.size());
  polled_parallel_for(faces.size(), kValuesPerPoll / 8, context, [&](std::size_t i) {
    const Triangle& f = faces[i];
    face[i] = measure_face(Patch{&body, patch[i]}, V[f[0]], V[f[1]], V[f[2]], h);
  });

  MeshCertificate::Boundary& boundary = certificate.boundary;
  begin_distances(boundary);
  for (std::size_t i = 0; i < vertices.size();) {
    const int v = vertices[i].first;
    double farthest = 0;
    for (; i < vertices.size() && vertices[i].first == v; ++i) farthest = std::max(farthest, distance[i]);
    add_vertex(V[v], farthest, h, certificate.coordinate_rounding + of.tolerance, boundary);
  }
  double gap = 0;
  for (const FaceMeasure& f : face) {
    add_face(f, h, boundary);
    if (f.found) add_gap(f, gap);
  }
  boundary.gap_over_volume = gap / certificate.volume;
}

}  // namespace umtet
