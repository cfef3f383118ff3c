#include "mesh/certificate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "mesh/orientation.h"
#include "mesh/quality_report.h"
#include "mesh/skin.h"
#include "mesh/tet_quality.h"

namespace umtet {
namespace {

// A tet takes about a microsecond, a foot point about ten values of psi.
constexpr std::size_t kTetsPerPoll = 1 << 16, kFeetPerPoll = kValuesPerPoll / 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct TetMeasure {
  double Q, volume, rms_edge, dihedral_min, dihedral_max;
  bool inverted;
};

TetMeasure measure(const TetMesh& mesh, const Tet& t) {
  const Vec3 &a = mesh.V[t[0]], &b = mesh.V[t[1]], &c = mesh.V[t[2]], &d = mesh.V[t[3]];
  const double l2 = sum_of_squared_edges(a, b, c, d);
  const DihedralRange angles = dihedral_range(a, b, c, d);
  TetMeasure m{mean_ratio(a, b, c, d), volume6(a, b, c, d) / 6.0,        std::sqrt(l2 / 6.0), angles.min_deg,
               angles.max_deg,         orientation_sign(a, b, c, d) <= 0};
  if (!std::isfinite(m.Q)) m.Q = -1;
  return m;
}

/// Fills n_tets, volume, quality and h.
void measure_tets(const TetMesh& mesh, double h, const KeepGoing& keep_going, MeshCertificate& certificate) {
  // Here and below, loops write by index and sums are taken in order: threads cannot change a result.
  std::vector<TetMeasure> measures(mesh.C.size());
  polled_parallel_for(mesh.C.size(), kTetsPerPoll, keep_going,
                      [&](std::size_t t) { measures[t] = measure(mesh, mesh.C[t]); });

  MeshCertificate::Quality& quality = certificate.quality;
  quality.dihedral_min_deg = 180;
  std::vector<double> Q;
  Q.reserve(measures.size());
  double sum_edges = 0;
  for (const TetMeasure& m : measures) {
    Q.push_back(m.Q);
    certificate.volume += m.volume;
    sum_edges += m.rms_edge;
    quality.n_inverted += m.inverted;
    quality.dihedral_min_deg = std::min(quality.dihedral_min_deg, m.dihedral_min);
    quality.dihedral_max_deg = std::max(quality.dihedral_max_deg, m.dihedral_max);
  }
  std::sort(Q.begin(), Q.end());
  const QualitySummary summary = summarize(Q);
  quality.min = summary.min;
  quality.p001 = summary.p001;
  quality.p01 = summary.p01;
  quality.mean = summary.mean;
  certificate.n_tets = mesh.C.size();
  certificate.h = h > 0 ? h : sum_edges / static_cast<double>(measures.size());
}

bool same_faces(std::vector<Triangle> x, std::vector<Triangle> y) {
  for (auto* faces : {&x, &y}) {
    for (Triangle& f : *faces) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    std::sort(faces->begin(), faces->end());
  }
  return x == y;
}

/// A point of psi = 0 near x.
struct Foot {
  bool found = false;
  double distance = kInfinity;
  Vec3 normal = Vec3::Zero();  ///< grad psi / |grad psi| there
};

/// Damped Newton along the gradient: from y to a point with |psi| <= tol |grad psi|. `y` and `g` are updated.
bool reach_zero_set(ImplicitFunctionRef psi, double step_cap, double tol, Vec3& y, Vec3& g) {
  double value = psi.value(y, g);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double slope2 = g.squaredNorm();
    if (!std::isfinite(value) || !(slope2 > 0) || !std::isfinite(slope2)) return false;
    const double slope = std::sqrt(slope2);
    if (std::abs(value) <= tol * slope) return true;
    Vec3 step = -value / slope2 * g;
    if (const double length = step.norm(); length > step_cap) step *= step_cap / length;
    Vec3 next_g;
    double next = psi.value(y + step, next_g);
    for (int halving = 0; halving < 20 && !(std::abs(next) < std::abs(value)); ++halving) {
      step *= 0.5;
      next = psi.value(y + step, next_g);
    }
    if (!(std::abs(next) < std::abs(value))) return false;
    y += step;
    value = next;
    g = next_g;
  }
  return false;
}

/// The closest point of psi = 0 to x, by alternating a step along the surface towards the foot of x and a return to the
/// surface. Only steps that come nearer are taken, so the distance is never below the true one nor above that of the
/// first point found. Written apart from the mesher's own projection on purpose: a certificate must not share its
/// errors.
Foot foot_point(ImplicitFunctionRef psi, const Vec3& x, double h) {
  Foot foot;
  Vec3 y = x, g;
  const double tol = 1e-12 * h;
  if (!reach_zero_set(psi, 0.5 * h, tol, y, g)) return foot;
  double distance = (y - x).norm();
  double relaxation = 1;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Vec3 w = g.normalized();
    const Vec3 slide = (x - y) - w.dot(x - y) * w;
    // The distance is second order in what is left of the slide.
    if (slide.norm() <= 1e-6 * distance + tol) break;
    Vec3 next = y + relaxation * slide, next_g;
    if (reach_zero_set(psi, 0.5 * h, tol, next, next_g) && (next - x).norm() < distance) {
      y = next;
      g = next_g;
      distance = (y - x).norm();
    } else if ((relaxation *= 0.5) < 1e-3) {
      break;
    }
  }
  foot.found = true;
  foot.distance = distance;
  foot.normal = g.normalized();
  return foot;
}

struct FaceMeasure {
  bool found;
  double distance, cos_normal;
};

/// Fills the distances and normals of the boundary.
void measure_against(ImplicitFunctionRef psi, const TetMesh& mesh, const std::vector<Triangle>& faces,
                     const std::vector<int>& vertices, double h, const KeepGoing& keep_going,
                     MeshCertificate::Boundary& boundary) {
  std::vector<double> vertex_distance(vertices.size());
  polled_parallel_for(vertices.size(), kValuesPerPoll, keep_going, [&](std::size_t i) {
    Vec3 g;
    const double value = psi.value(mesh.V[vertices[i]], g);
    const double d = value == 0 ? 0 : std::abs(value) / g.norm();
    vertex_distance[i] = std::isnan(d) ? kInfinity : d;
  });
  std::vector<FaceMeasure> face(faces.size());
  polled_parallel_for(faces.size(), kFeetPerPoll, keep_going, [&](std::size_t i) {
    const Vec3 &a = mesh.V[faces[i][0]], &b = mesh.V[faces[i][1]], &c = mesh.V[faces[i][2]];
    const Foot foot = foot_point(psi, (a + b + c) / 3.0, h);
    const Vec3 n = (b - a).cross(c - a);
    const double length = n.norm();
    face[i] = {foot.found, foot.distance, length > 0 ? n.dot(foot.normal) / length : -1.0};  // no area: no normal
  });

  double max_vertex = 0, max_centroid = 0, min_cos = 1;
  for (const double d : vertex_distance) max_vertex = std::max(max_vertex, d);
  for (const FaceMeasure& f : face) {
    if (!f.found) {
      ++boundary.n_unprojected_faces;
      continue;
    }
    max_centroid = std::max(max_centroid, f.distance);
    min_cos = std::min(min_cos, f.cos_normal);
    boundary.n_cos_below_half += f.cos_normal < 0.5;
  }
  boundary.max_vertex_distance_over_h = max_vertex / h;
  boundary.max_centroid_distance_over_h = max_centroid / h;
  boundary.min_cos_normal = min_cos;
}

std::string text(const char* format, double value) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

}  // namespace

MeshCertificate certify(const CertificateInput& input) {
  if (!input.mesh || input.mesh->C.empty()) throw std::invalid_argument("certify: a mesh with tets is needed");
  const TetMesh& mesh = *input.mesh;
  poll(input.keep_going);
  const BoundaryFaces skin = boundary_faces(mesh.C, mesh.V.size());  // checks the indices
  poll(input.keep_going);
  const SurfaceTopology topology = surface_topology(mesh.V, skin.triangles);

  MeshCertificate certificate;
  measure_tets(mesh, input.h, input.keep_going, certificate);
  certificate.coordinate_rounding = input.coordinate_rounding;
  std::vector<char> used(mesh.V.size(), 0);
  for (const Tet& t : mesh.C) {
    for (const int v : t) used[v] = 1;
  }
  certificate.n_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));

  MeshCertificate::Boundary& boundary = certificate.boundary;
  boundary.n_faces = skin.triangles.size();
  boundary.n_overused_faces = skin.n_overused;
  boundary.n_same_side_faces = skin.n_same_side;
  boundary.n_nonmanifold_edges = topology.n_nonmanifold_edges;
  boundary.n_nonmanifold_vertices = topology.n_nonmanifold_vertices;
  boundary.closed_manifold = topology.closed_manifold && skin.n_overused == 0 && skin.n_same_side == 0;
  boundary.components = static_cast<int>(topology.components.size());
  boundary.euler_characteristic = topology.euler_characteristic;
  boundary.genus = topology.genus;
  boundary.area = topology.area;
  if (input.positive_faces) {
    certificate.n_positive_faces = input.positive_faces->size();
    boundary.equals_positive_faces = same_faces(skin.triangles, *input.positive_faces);
  }
  if (input.psi) {
    measure_against(*input.psi, mesh, skin.triangles, topology.vertices, certificate.h, input.keep_going, boundary);
  }
  return certificate;
}

std::vector<std::string> failures(const MeshCertificate& certificate) {
  std::vector<std::string> reasons;
  const auto count = [&](std::size_t n, const char* what) {
    if (n > 0) reasons.push_back(std::to_string(n) + " " + what);
  };
  const MeshCertificate::Boundary& b = certificate.boundary;
  count(certificate.quality.n_inverted, "tets are inverted or flat (exact sign of the volume)");
  count(b.n_overused_faces, "faces belong to more than two tets");
  count(b.n_same_side_faces, "faces have both their tets on the same side");
  count(b.n_nonmanifold_edges, "boundary edges do not have exactly two boundary faces");
  count(b.n_nonmanifold_vertices, "boundary vertices join more than one fan of boundary faces");
  if (!b.closed_manifold) reasons.emplace_back("the boundary is not a closed 2-manifold");
  if (b.equals_positive_faces == false) {
    reasons.push_back("the boundary (" + std::to_string(b.n_faces) + " faces) is not the set of positive faces (" +
                      std::to_string(certificate.n_positive_faces) + ")");
  }
  const double tolerance = kVertexTolerance + certificate.coordinate_rounding / certificate.h;
  if (b.max_vertex_distance_over_h && !(*b.max_vertex_distance_over_h <= tolerance)) {
    reasons.push_back(text("a boundary vertex is %.3g h from psi = 0, more than rounding explains",
                           *b.max_vertex_distance_over_h));
  }
  count(b.n_unprojected_faces, "boundary faces have no point of psi = 0 near their centroid");
  if (b.min_cos_normal && !(*b.min_cos_normal > 0)) {
    reasons.push_back(text("the boundary is folded: cos(face normal, grad psi) is down to %.3g", *b.min_cos_normal));
  }
  return reasons;
}

}  // namespace umtet
