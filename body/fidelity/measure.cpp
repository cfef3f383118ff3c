#include "body/fidelity/measure.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "body/fidelity/closed_holes.h"
#include "body/fidelity/feature_report.h"
#include "body/fidelity/mesh_defects.h"
#include "body/fidelity/mesh_sizes.h"
#include "body/fidelity/missed_samples.h"
#include "body/fidelity/patch_measures.h"
#include "body/fidelity/triangle_distances.h"
#include "body/label_volume.h"
#include "body/pieces/component_proof.h"
#include "body/piecewise_body.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/sheets.h"
#include "common/formatted.h"
#include "common/polled_loops.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/curvature.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/implicit/thickness.h"
#include "mesh/sizes/graded_zero_set.h"

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

// In edges: sheets farther than this do not matter.
constexpr double kFarthestSheet = 4;

/// Boundary vertices and how thin it is there: the distance along the normal to the opposite sheet, inside or outside,
/// up to kFarthestSheet.
struct VertexThickness {
  std::vector<Vec3> vertices;
  std::vector<double> thickness;  ///< model units
  double least_over_h = 0;        ///< of any vertex, in the h of its place
  std::vector<Vec3> thin;         ///< those where it is less than kLeastEdgesAcross h
};

VertexThickness vertex_thickness(const Domain& domain, const TetMesh& mesh, const std::vector<int>& boundary,
                                 const MeshEdge& h, const Context& context) {
  VertexThickness made;
  for (const int i : boundary) made.vertices.push_back(mesh.V[i]);
  if (made.vertices.empty()) return made;
  const std::vector<double> h_at = h.at(made.vertices);
  made.thickness = body_thickness(domain, made.vertices, h_at, .25, kFarthestSheet, context);
  made.least_over_h = kFarthestSheet;
  for (std::size_t i = 0; i < made.vertices.size(); ++i) {
    made.least_over_h = std::min(made.least_over_h, made.thickness[i] / h_at[i]);
    if (made.thickness[i] < kLeastEdgesAcross * h_at[i]) made.thin.push_back(made.vertices[i]);
  }
  return made;
}

/// Points of psi = 0 and how thin it is there, model units.
struct PointThickness {
  std::vector<Vec3> points;
  std::vector<double> thickness;
};

/// Of the boundary vertices, and of what the mesh has lost of psi = 0: there it may be thin where no vertex is.
PointThickness with_lost_parts(const VertexThickness& vertices, const std::vector<Difference>& lost,
                               const Domain& domain, const MeshEdge& h, const Context& context) {
  PointThickness all;
  for (const Difference& d : lost) all.points.push_back(d.where);
  all.thickness = body_thickness(domain, all.points, h.at(all.points), .25, kFarthestSheet, context);
  all.points.insert(all.points.end(), vertices.vertices.begin(), vertices.vertices.end());
  all.thickness.insert(all.thickness.end(), vertices.thickness.begin(), vertices.thickness.end());
  return all;
}

/// Where it is thinner than the longest edges on which psi = 0 was counted there, the diagonals of a grid's cubes: the
/// worst place, if there is one.
/// @param sizes  of a graded mesh
std::optional<Vec3> unseen_thickness(const PointThickness& thickness, const ZeroSetChoice& counted,
                                     const SizeField* sizes) {
  std::optional<Vec3> worst;
  double least = 1;
  for (std::size_t i = 0; i < thickness.points.size(); ++i) {
    const double edge = sizes ? kLongestCountedEdge * counted.share * sizes->at(thickness.points[i])
                              : std::sqrt(3.) * counted.topology.spacing;
    if (thickness.thickness[i] < least * edge) least = thickness.thickness[i] / edge, worst = thickness.points[i];
  }
  return worst;
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

// A count is repeated only if the bound on nodes lets the new spacing be less than this share of the former one; on a
// graded mesh, where it makes four times as many, if there are fewer than this many edges.
constexpr double kWorthRepeating = .9;
constexpr std::size_t kMostRepeated = 10'000'000;

constexpr double kRightAngle = 89;  // degrees: edges of 90 degrees are not acute within the error of their curve
// In h: a piece or a handle of psi = 0 that the mesh lacks has points farther from the mesh.
constexpr double kShown = .5;

/// What psi = 0 has, and where the mesh differs from it, if it does.
struct Comparison {
  ZeroSetReport report;
  std::optional<MeshDefect> defect;
};

/// What compare_with_zero_set() looks at besides the mesh and the pieces.
struct ComparisonParams {
  const PointThickness& thickness;
  const SurfaceDistance* surface;  ///< null: the mesh has no boundary
  const MeshEdge& h;
  const SizeField* sizes;         ///< of a graded mesh, or null
  const PiecewiseMesh* features;  ///< the mesh with its sharp edges, or null
};

/// Whether a curve has an acute edge of the body or of the space around it. Beside such an edge, body or gap are
/// thinner than any spacing, and a count can be wrong there on the finest grid: the points of a grid in a wedge are
/// separate pieces where no edge of the grid between them stays inside.
bool has_acute_edge(const PiecewiseMesh& mesh) {
  return std::any_of(mesh.graph.curves.begin(), mesh.graph.curves.end(), [](const FeatureCurve& c) {
    return std::any_of(c.angle_deg.begin(), c.angle_deg.end(),
                       [](double angle) { return angle < kRightAngle || angle > 360 - kRightAngle; });
  });
}

/// Another count, on edges half as long, if it is worth it.
std::optional<ZeroSetChoice> finer_count(const Domain& domain, const ZeroSetChoice& pieces,
                                         const ComparisonParams& params, const Context& context) {
  const SignCells* cells = pieces.cells ? &*pieces.cells : nullptr;
  if (params.sizes) {
    if (pieces.topology.cut_points.size() > kMostRepeated) return std::nullopt;
    return choose_components(domain, *params.sizes, params.h.nominal(), pieces.share / 2, context, cells);
  }
  const double half = pieces.topology.spacing / 2;
  if (counting_spacing(domain, half) >= kWorthRepeating * pieces.topology.spacing) return std::nullopt;
  return choose_components(domain, half, context, cells);
}

/// Does the boundary of the mesh look like the pieces of psi = 0 that are kept, and the walls of the box around a
/// fluid, one closed piece without a hole? Where the two counts differ, the count is repeated on edges half as long, as
/// far as its size is allowed. A count on a grid coarser than the mesh says nothing against the mesh, and one coarser
/// than body or gap are thin nothing for it. Of a body with acute edges, a count says nothing against a mesh that
/// passes near every point of psi = 0.
Comparison compare_with_zero_set(const Domain& domain, const MeshCertificate& certificate, const ZeroSetChoice& pieces,
                                 const ComparisonParams& params, const Context& context) {
  const MeshCertificate::Boundary& boundary = certificate.boundary;
  const int of_psi = boundary.components - (domain.complement ? 1 : 0);
  const long characteristic = boundary.euler_characteristic - (domain.complement ? 2 : 0);
  const auto differs = [&](const ZeroSetChoice& c) {
    return static_cast<int>(c.seeds.size()) != of_psi || c.euler_characteristic != characteristic;
  };
  const std::optional<ZeroSetChoice> repeated =
      differs(pieces) ? finer_count(domain, pieces, params, context) : std::nullopt;
  const ZeroSetChoice* counted = repeated ? &*repeated : &pieces;
  Comparison made;
  ZeroSetReport& report = made.report;
  report.counting_spacing = counted->share > 0
                                ? kLongestCountedEdge / std::sqrt(3.) * counted->share * params.h.nominal()
                                : counted->topology.spacing;
  report.components_of_zero_set = counted->topology.components.size();
  report.euler_characteristic_of_zero_set = counted->topology.euler_characteristic;
  report.components_kept = counted->seeds.size();
  report.euler_characteristic_of_kept_components = counted->euler_characteristic;
  report.components_meshed = of_psi;
  report.euler_characteristic_meshed = characteristic;
  report.components_dropped = counted->dropped;
  if (!differs(*counted)) {
    if (const auto where = unseen_thickness(params.thickness, *counted, params.sizes)) {
      report.topology = TopologyProof::NotProved;
      report.topology_at = *where + domain.shift;
    }
    return made;
  }
  const auto n_pieces = static_cast<std::size_t>(std::abs(static_cast<int>(counted->seeds.size()) - of_psi));
  const auto n_handles = static_cast<std::size_t>(std::abs(counted->euler_characteristic - characteristic) / 2);
  const std::size_t n = std::max<std::size_t>(1, n_pieces + n_handles);
  MeshDefect defect{.kind = DefectKind::Topology, .n = n};
  if (params.surface) defect = topology_defect(domain, *counted, *params.surface, params.h, n, context);
  const bool is_coarser = counted->share == 0 && counted->topology.spacing > params.h.least();
  const bool is_wedge = params.features && has_acute_edge(*params.features) && defect.off_over_h < kShown;
  const bool is_unsure = is_coarser || is_wedge;
  report.topology = is_unsure ? TopologyProof::NotProved : TopologyProof::Differs;
  report.topology_at = defect.where;
  if (report.topology == TopologyProof::Differs) made.defect = defect;
  return made;
}

/// With the proof that no piece is unseen, and what of the boundary is a guess.
Comparison compare_with_domain(const Domain& domain, const TetMesh& mesh, const std::vector<Triangle>& faces,
                               const MeshCertificate& certificate, const ZeroSetChoice& pieces,
                               const ComparisonParams& params, const Context& context) {
  Comparison made = compare_with_zero_set(domain, certificate, pieces, params, context);
  ZeroSetReport& report = made.report;
  if (domain.level_set) report.level_set_spacing = domain.level_set->spacing();
  if (domain.level_set && pieces.cells) {
    const ComponentProof proof = prove_components(*domain.level_set, domain.box, pieces.topology, *pieces.cells);
    report.components_proved = proof.unseen.empty() && proof.n_open == 0;
    for (const Vec3& at : proof.unseen) {
      const Vec3 x = at + domain.shift;
      report.components_dropped.push_back(
          formatted("piece at (%.6g, %.6g, %.6g): smaller than an edge", x.x(), x.y(), x.z()));
    }
  }
  if (domain.has_samples()) report.support = support_report(domain, mesh.V, faces, context);
  return made;
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
  Comparison compared =
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
    m.features = feature_report(domain.piecewise->domain, *params.features, h.nominal());
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
