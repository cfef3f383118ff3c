#include "body/fidelity/measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "body/fidelity/feature_report.h"
#include "body/fidelity/mesh_defects.h"
#include "body/fidelity/mesh_sizes.h"
#include "body/fidelity/mesh_thickness.h"
#include "body/fidelity/missed_samples.h"
#include "body/fidelity/patch_measures.h"
#include "body/fidelity/triangle_distances.h"
#include "body/fidelity/zero_set_comparison.h"
#include "body/label_volume.h"
#include "body/piecewise_body.h"
#include "body/sizing/edge_length.h"
#include "common/formatted.h"
#include "common/polled_loops.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/curvature.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {
namespace {

/// Largest principal curvature of psi = 0 at the boundary vertices, in magnitude, times h.
double max_curvature(ImplicitFunctionRef psi, const TetMesh& mesh, const std::vector<int>& I, const MeshEdge& h,
                     const Context& context) {
  std::vector<double> kappa_h(I.size());
  for_each_asking(psi, I.size(), kValuesPerPoll, context, [&](std::size_t k) {
    const Vec3& x = mesh.V[I[k]];
    kappa_h[k] = h.at(x) * principal_curvatures(psi, x)[0];
  });
  return kappa_h.empty() ? 0 : *std::max_element(kappa_h.begin(), kappa_h.end());
}

// At least this many samples, and this share of all, have to be far from the mesh before it is said to lack something.
constexpr std::size_t kFewSamples = 10;
constexpr double kSmallShare = 1e-3;

/// Which of the places are within the radius of support of a piece that was left out: they have been judged.
std::vector<std::uint8_t> near_dropped_pieces(const Domain& domain, const ZeroSetChoice& pieces,
                                              const std::vector<Vec3>& places, const Context& context) {
  const ZeroSetTopology& topology = pieces.topology;
  std::vector<Vec3> points;
  for (std::size_t c = 0; c < topology.components.size(); ++c) {
    if (std::find(pieces.kept.begin(), pieces.kept.end(), c) != pieces.kept.end()) continue;
    const auto of_piece = topology.points_of(topology.components[c]);
    points.insert(points.end(), of_piece.begin(), of_piece.end());
  }
  std::vector<std::uint8_t> is_near(places.size(), 0);
  if (points.empty()) return is_near;
  const double radius = std::max(support_radius(domain), topology.spacing);
  const std::vector<double> d = SampleDistance(std::move(points)).distances(places, context);
  std::transform(d.begin(), d.end(), is_near.begin(), [&](double v) { return v <= radius ? 1 : 0; });
  return is_near;
}

/// Samples that psi, with all its detail, passes by, and the mesh does not: what has been too small for h. Empty where
/// they are few.
/// @param d  distances of the samples to the mesh
std::vector<Difference> lost_samples(const Domain& domain, const ZeroSetChoice& pieces, const std::vector<double>& d,
                                     const MeshEdge& h, const Context& context) {
  std::vector<Vec3> x;
  std::vector<double> distance, h_of;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= h.least()) continue;
    const double h_at = h.at(domain.cloud.points[i]);
    if (d[i] > h_at) x.push_back(domain.cloud.points[i]), distance.push_back(d[i]), h_of.push_back(h_at);
  }
  if (x.empty()) return {};
  std::vector<std::uint8_t> lost = near_dropped_pieces(domain, pieces, x, context);
  const LevelSet& psi = domain.fitted->whole();
  polled_parallel_for(x.size(), kValuesPerPoll, context, [&](std::size_t i) {
    Vec3 g;
    const double value = psi.evaluate(x[i], &g, nullptr);
    lost[i] = lost[i] == 0 && distance[i] > h_of[i] + std::abs(value) / g.norm() ? 1 : 0;
  });
  const auto n = static_cast<std::size_t>(std::count(lost.begin(), lost.end(), 1));
  if (n <= kFewSamples || static_cast<double>(n) <= kSmallShare * static_cast<double>(d.size())) return {};
  std::vector<Difference> all;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (lost[i]) all.push_back({DefectKind::Missed, x[i], distance[i]});
  }
  return all;
}

/// Closed triangles say what the body is. What psi = 0 has and they have not, such as an ear at a corner, is a fault of
/// psi: a mesh that lacks it is right.
void leave_out_faults_of_psi(const Domain& domain, const MeshEdge& h, const Context& context,
                             std::vector<Difference>& differences) {
  if (!domain.triangles || !domain.triangles->body.is_closed) return;
  std::vector<Vec3> x;
  x.reserve(differences.size());
  for (const Difference& d : differences) x.push_back(d.where);
  const std::vector<double> off = domain.triangles->distance.distances(x, context);
  std::size_t k = 0;
  std::erase_if(differences, [&](const Difference& d) {
    const bool is_of_psi = d.kind == DefectKind::Thin || d.kind == DefectKind::Filled || d.kind == DefectKind::Cut;
    return off[k++] > kSmallOff * h.at(d.where) && is_of_psi;
  });
}

/// The boundary has the pieces and handles of the given triangles.
bool has_topology_of(const std::optional<TriangleDistances>& triangles) {
  if (!triangles || !triangles->body || !triangles->body->is_closed || !triangles->body->is_manifold) return false;
  return triangles->mesh.n_pieces == triangles->body->n_pieces &&
         triangles->mesh.euler_characteristic == triangles->body->euler_characteristic;
}

/// The largest distance asked for with mesh.max_deviation is a promise: a mesh that breaks it gets a reason.
std::optional<std::string> deviation_reason(double asked, const MeshCertificate& mesh) {
  if (asked == 0 || !mesh.boundary.max_centroid_distance_over_h) return std::nullopt;
  const double made = mesh.boundary.max_centroid_distance;
  if (made <= asked) return std::nullopt;
  return formatted("a face centre is %.4g from psi = 0, more than the largest allowed deviation of %.4g", made, asked);
}

/// certify() with the patches of the mesh.
MeshCertificate certify_patches(const PiecewiseBody& body, CertificateInput input, const PiecewiseMesh& features) {
  input.psi.reset();
  MeshCertificate certificate = certify(input);
  measure_against_patches(body, input.mesh->V, features.faces, features.face_patch, input.context, certificate);
  return certificate;
}

/// Those that the certificate of the tets has.
void set_reasons(MeshMeasures& m) {
  m.reasons = invalidities(m.mesh);
  m.is_valid = m.reasons.empty();
  for (std::string& reason : coarseness(m.mesh)) m.reasons.push_back(std::move(reason));
}

}  // namespace

MeshCertificate certify_against(const Domain& domain, CertificateInput input) {
  input.psi.reset();
  if (!domain.piecewise) input.psi = domain.psi();
  MeshCertificate certificate = certify(input);
  if (!domain.piecewise) return certificate;
  const std::vector<Triangle> faces = boundary_faces(input.mesh->C, input.mesh->V.size()).triangles;
  const std::vector<int> patch = patches_by_position(domain, input.mesh->V, faces, certificate.h, input.context);
  measure_against_patches(*domain.piecewise, input.mesh->V, faces, patch, input.context, certificate);
  return certificate;
}

MeshEdge mesh_edge(const BackgroundMesh& background, const UmResult& result, double h) {
  const std::vector<int>& I = result.submesh.positive_vertices;
  // The box with walls is a lattice but for its outermost tets.
  if (background.is_lattice() || !result.walls.empty() || I.empty()) return h;
  std::vector<Vec3> vertices;
  std::vector<double> h_of;
  for (const int i : I) {
    vertices.push_back(result.final[i]);
    h_of.push_back(background.h(result.submesh.background_vertex[i]));
  }
  return {h, vertices, std::move(h_of)};
}

Measurement measure(const Domain& domain, const TetMesh& mesh, const UmResult& result, const ZeroSetChoice& pieces,
                    const MeshEdge& h, const MeasureParams& params, const Context& context) {
  const std::vector<int>& boundary_vertices = result.submesh.positive_vertices;
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h.nominal();
  std::vector<double> local_h;
  if (!h.is_uniform()) {
    local_h.assign(mesh.V.size(), h.nominal());
    for (const int i : boundary_vertices) local_h[i] = h.at(mesh.V[i]);
    input.local_h = &local_h;
  }
  input.positive_faces = &result.submesh.positive_faces;
  if (!result.walls.empty()) {
    input.wall_faces = &result.walls;
    input.background_V = &result.submesh.mesh.V;
  }
  input.coordinate_rounding = coordinate_rounding(domain);
  input.context = context;
  Measurement made;
  MeshMeasures& m = made.measures;
  if (domain.has_samples()) m.n_points = domain.cloud.points.size();
  m.input = domain.facts;
  m.mesh = params.certificate ? *params.certificate
           : params.features  ? certify_patches(*domain.piecewise, std::move(input), *params.features)
                              : certify_against(domain, std::move(input));
  m.coordinate_rounding_over_h = m.mesh.coordinate_rounding / m.mesh.h;
  set_reasons(m);
  if (auto reason = deviation_reason(params.max_deviation, m.mesh)) m.reasons.push_back(std::move(*reason));

  const std::vector<Triangle>& faces = result.submesh.positive_faces;
  // No face: the body lies between the vertices of the background.
  std::optional<SurfaceDistance> surface;
  if (!faces.empty()) surface.emplace(mesh.V, faces);
  const VertexThickness thickness = vertex_thickness(domain, mesh, boundary_vertices, h, context);
  std::vector<Difference> lost, flips;
  if (surface) {
    const std::vector<Vec3> psi_points = kept_points(pieces);
    std::vector<Vec3> starts = thickness.thin;
    starts.insert(starts.end(), m.mesh.boundary.far_feet.begin(), m.mesh.boundary.far_feet.end());
    lost = lost_parts(domain, psi_points, starts, *surface, h, context);
    flips = flips_that_show(result.manifold_flips, psi_points, *surface, h, context);
  }
  const PointThickness everywhere = with_lost_parts(thickness, lost, domain, h, context);
  ZeroSetComparison compared =
      compare_with_domain(domain, mesh, faces, m.mesh, pieces,
                          {everywhere, surface ? &*surface : nullptr, h, params.sizes, params.features}, context);
  m.domain = std::move(compared.report);
  std::vector<Difference> differences = differences_of(m.mesh);
  const auto add = [&](const std::vector<Difference>& more) {
    differences.insert(differences.end(), more.begin(), more.end());
  };
  add(flips);
  add(lost);
  if (surface && !domain.cloud.points.empty()) {
    std::vector<double> d = surface->distances(domain.cloud.points, context);
    if (domain.fitted) add(lost_samples(domain, pieces, d, h, context));
    m.cloud = sample_distances(domain, before_merging(domain.cloud, std::move(d)), h,
                               m.mesh.boundary.max_centroid_distance_over_h.value_or(0));
  }
  if (surface && domain.triangles) m.triangles = triangle_distances(domain, mesh.V, faces, *surface, h, context);
  if (domain.labels && !domain.complement && !params.certificate)
    m.labels = label_volume_report(domain, mesh, faces, context);
  leave_out_faults_of_psi(domain, h, context, differences);
  made.defects = defects_of(domain, differences, h, context);
  if (compared.defect && !has_topology_of(m.triangles)) made.defects.push_back(*compared.defect);
  if (params.features) {
    m.features = feature_report(domain.piecewise->domain, *params.features);
    const std::vector<MeshDefect> missed = missed_features(domain, *params.features, *surface, h, context);
    made.defects.insert(made.defects.end(), missed.begin(), missed.end());
  }
  m.defects = report_on(made.defects);
  m.resolution.kappa_h_max = max_curvature(domain.psi(), mesh, boundary_vertices, h, context);
  m.resolution.feature_size_over_h_min = thickness.least_over_h;
  m.resolution.obtuse_conditioning_angles = result.obtuse_conditioning_angles;
  m.resolution.double_positive_faces = result.double_positive_faces;
  if (params.thin) m.resolution.too_thin = in_model(*params.thin, domain.shift);
  if (params.sizes) m.sizes = sizes_report(mesh, faces, asked_sizes(*params.sizes, mesh.V, context));
  return made;
}

MeshMeasures measures_of(MeshCertificate certificate, const Domain* domain, const Context& context) {
  MeshMeasures m;
  m.mesh = std::move(certificate);
  set_reasons(m);
  if (domain) {
    std::vector<MeshDefect> defects = defects_of(*domain, differences_of(m.mesh), m.mesh.h, context);
    m.defects = report_on(defects);
  }
  return m;
}

}  // namespace umtet
