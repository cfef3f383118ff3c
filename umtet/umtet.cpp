#include "umtet/umtet.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "body/edges/edged_body.h"
#include "body/edges/edged_cloud.h"
#include "body/errors.h"
#include "body/fidelity/closed_holes.h"
#include "body/given_triangles.h"
#include "body/option_names.h"
#include "body/piecewise_body.h"
#include "body/scan/fitted_domain.h"
#include "body/scan/given_cloud.h"
#include "body/scan/level_set_fit.h"
#include "body/scan/sample_merging.h"
#include "body/search/best_mesh.h"
#include "body/search/mesh_maker.h"
#include "body/sizing/background_choice.h"
#include "common/formatted.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/cloud/transfer/label_votes.h"

namespace umtet {
namespace {

/// Throws the error that explains why the attempt has no mesh.
[[noreturn]] void refuse(const MeshAttempt& best, const Vec3& shift) {
  if (best.fell_through()) {
    throw TooThin(formatted("%s\n  h = %.3g may show them", too_thin_text(best, shift).c_str(), best.thin.h_needed()),
                  {in_model(best.thin, shift), best.thin.h, {}});
  }
  const UmEvidence& e = best.result.evidence;
  const Vec3 at = e.where + shift;
  throw MeshingImpossible(formatted("no mesh at h = %.6g: %s: %s, at (%.9g, %.9g, %.9g)", best.h,
                                    to_string(best.result.status), e.what.c_str(), at.x(), at.y(), at.z()));
}

/// The labels of the faces by the samples next to them; empty where the samples have none.
std::vector<int> labels_of(const OrientedPointCloud& cloud, const std::vector<Vec3>& V,
                           const std::vector<Triangle>& faces) {
  if (cloud.labels.empty()) return {};
  std::vector<Vec3> centroids, normals;
  for (const auto& [a, b, c] : faces) {
    centroids.push_back((V[a] + V[b] + V[c]) / 3);
    normals.push_back((V[b] - V[a]).cross(V[c] - V[a]).normalized());
  }
  return vote_labels(cloud, centroids, normals);
}

/// The faces of which all vertices are in walls of the box; empty without walls.
std::vector<char> faces_at_walls(const Mesh& mesh, const std::vector<Triangle>& faces) {
  if (mesh.walls.empty()) return {};
  std::vector<char> at_wall(mesh.points.size(), 0), found;
  for (const Triangle& f : mesh.walls) {
    for (const int v : f) at_wall[v] = 1;
  }
  for (const Triangle& f : faces) {
    found.push_back(std::all_of(f.begin(), f.end(), [&](int v) { return at_wall[v]; }) ? 1 : 0);
  }
  return found;
}

/// Divides the boundary of the mesh.
/// @param of_body  patch of each boundary face in a body with sharp edges; empty for a smooth body
/// @param mesh     in the coordinates of the domain
void set_patches(const Domain& domain, const Options& options, const std::vector<int>& of_body, Mesh& mesh) {
  std::vector<Triangle> faces = mesh.boundary;
  faces.insert(faces.end(), mesh.walls.begin(), mesh.walls.end());
  BoundaryDivision division =
      divide_boundary(mesh.points, faces, faces_at_walls(mesh, faces), domain.cloud, options.patches, of_body,
                      domain.piecewise ? domain.piecewise->labels : std::vector<int>());
  const std::optional<SupportReport>& support = mesh.measures.domain.support;
  if (support && support->n_closed_holes > 0) {
    const ClosedHoles holes = find_closed_holes(domain, mesh.points, mesh.boundary, options.context);
    std::vector<char> in_holes(faces.size(), 0);
    std::transform(holes.of_face.begin(), holes.of_face.end(), in_holes.begin(), [](int hole) { return hole >= 0; });
    take_holes(in_holes, division);
  }
  mesh.patches = std::move(division.patches);
  mesh.face_patch = std::move(division.face_patch);
  mesh.notices.insert(mesh.notices.end(), division.notices.begin(), division.notices.end());
}

Mesh mesh_of(Domain domain, const Options& options) {
  require_patches(domain.cloud, options.patches);
  MeshAttempt best = best_mesh(domain, options.body, options.max_memory, options.context);
  if (!best.made()) refuse(best, domain.shift);
  UmResult& result = best.result;
  Mesh mesh{.points = std::move(result.final),
            .tets = std::move(result.submesh.mesh.C),
            .boundary = std::move(result.submesh.positive_faces),
            .walls = std::move(result.walls),
            .h = best.h,
            .measures = std::move(best.measured),
            .verdict = {},
            .notices = std::move(domain.notices)};
  if (best.features) mesh.curves = best.features->chains;
  mesh.labels = labels_of(domain.cloud, mesh.points, mesh.boundary);
  set_patches(domain, options, best.features ? best.features->face_patch : std::vector<int>(), mesh);
  for (Vec3& x : mesh.points) x += domain.shift;
  if (best.second) {
    mesh.curved = std::move(best.second->mesh);
    for (Vec3& x : mesh.curved->V) x += domain.shift;
  }
  mesh.verdict = judge(mesh.measures, options.verdict);
  return mesh;
}

/// @param of_triangles  what the samples are of; null: a scan
FittedBody fit(PreparedCloud prepared, const TriangleReport* of_triangles, const Options& options) {
  std::optional<ExactSamples> exact;
  if (of_triangles && prepared.report.normals.given) exact = ExactSamples{of_triangles->least_spacing};
  LevelSetFit fit =
      fit_level_set(prepared.cloud, std::move(prepared.near), options.body, options.context, nullptr, exact);
  FittedBody body{.psi = std::move(fit.psi),
                  .cloud = std::move(prepared.cloud),
                  .report = std::move(fit.report),
                  .facts = {},
                  .notices = std::move(prepared.report.notices)};
  body.facts = input_facts(prepared.report, body.report);
  body.notices.insert(body.notices.end(), fit.notices.begin(), fit.notices.end());
  return body;
}

BodySampleParams sample_params(const Options& options) {
  BodySampleParams params = options.triangles;
  if (params.spacing == 0) params.spacing = options.body.mesh.h / kSamplesAnEdge;
  const Closing close = options.body.fit.close;
  params.cap = params.cap && close != Closing::Smooth && close != Closing::None;
  params.turn = params.turn && options.body.scan.normals != NormalsOf::Given;
  return params;
}

/// The samples as a reader of files returns them.
CloudFile sampled_cloud(OrientedPointCloud samples, const TriangleReport& report, const Options& options) {
  const std::size_t n = samples.points.size();
  if (n < kFewestSurveyed) {
    throw CloudRefused(formatted("triangles: %zu of %zu samples lie on the boundary of a body, %zu are needed", n,
                                 report.n_samples, kFewestSurveyed),
                       {{Change::Lower, option::sample_spacing},
                        {Change::Give, {option::normals, "given"}, "if the sides of the triangles are right"}});
  }
  CloudFile file{.cloud = std::move(samples), .report = {}};
  file.report.n_points = n;
  file.report.of_triangles = options.body.scan.normals != NormalsOf::Estimate;
  if (!file.report.of_triangles) file.cloud.normals.clear();
  return file;
}

/// The domain of a function, without the function. \throw std::invalid_argument  there is no box
Domain domain_in_box(const Options& options) {
  if (!options.box) throw std::invalid_argument("box: missing; a function needs a box around the region where psi < 0");
  Domain domain;
  domain.box = *options.box;
  domain.diagonal = options.box->diagonal().norm();
  return domain;
}

/// \throw std::invalid_argument  a mesh that is no mesh of triangles
void require_triangles(const TriangleMesh& mesh) {
  const auto n = static_cast<int>(mesh.V.size());
  for (const Triangle& f : mesh.F)
    for (const int v : f)
      if (v < 0 || v >= n) throw std::invalid_argument("triangles: an index that the vertices do not have");
  for (const std::array<int, 2>& line : mesh.lines)
    for (const int v : line)
      if (v < 0 || v >= n) throw std::invalid_argument("triangles: an index of a line that the vertices do not have");
  if (!mesh.labels.empty() && mesh.labels.size() != mesh.F.size())
    throw std::invalid_argument("triangles: as many labels as triangles are needed, or none");
  for (const Vec3& x : mesh.V)
    if (!x.allFinite()) throw std::invalid_argument("triangles: a coordinate is not finite");
}

PreparedCloud prepare(CloudFile file, const char* name, const Options& options) {
  options.context.report("prepare", 0);
  return prepare_merged(std::move(file), name, options.body);
}

/// Triangles that bound a body, and their samples.
struct SampledTriangles {
  PreparedCloud samples;
  TriangleMesh boundary;
  TriangleReport report;
};

SampledTriangles sampled(TriangleMesh triangles, const Options& options) {
  require_triangles(triangles);
  options.context.report("sample", 0);
  BodySamples samples =
      sample_body(std::move(triangles), sample_params(options), {.cancelled = options.context.cancelled});
  CloudFile file = sampled_cloud(std::move(samples.cloud), samples.report, options);
  return {prepare(std::move(file), "triangles", options), std::move(samples.boundary), std::move(samples.report)};
}

FittedBody fit(SampledTriangles triangles, const Options& options) {
  FittedBody body = fit(std::move(triangles.samples), &triangles.report, options);
  body.boundary = std::move(triangles.boundary);
  body.triangles = std::move(triangles.report);
  return body;
}

/// Meshes of bodies with sharp edges have flat tets of the fast mode, without walls, in a background of the library.
bool may_keep_edges(const Options& options) {
  const MeshOptions& mesh = options.body.mesh;
  return options.body.fit.edges != SharpEdgeUse::Off && options.body.scan.normals != NormalsOf::Estimate &&
         mesh.order == 1 && mesh.mode == UmMode::Fast && !mesh.box_walls && !has_own_background(options.body);
}

/// The mesh of a body with sharp edges; none if it is not right: then one smooth level set may do.
std::optional<Mesh> right_mesh(Domain domain, const Options& options) {
  try {
    Mesh mesh = mesh_of(std::move(domain), options);
    const Verdict& v = mesh.verdict;
    if (v.passes() || (v.is_valid && v.fits_psi && v.fits_input)) return mesh;
  } catch (const MeshingImpossible&) {
  } catch (const ResourceLimit&) {
  }
  return std::nullopt;
}

/// The mesh with the sharp edges of a cloud; none if there are no such edges, or if it is not right.
std::optional<Mesh> mesh_with_edges(const PreparedCloud& prepared, const Options& options) {
  if (!may_keep_edges(options) || options.body.fit.edges != SharpEdgeUse::Auto) return std::nullopt;
  const EdgedCloud edged = edged_cloud(prepared.cloud, prepared.near, prepared.report.normals.given,
                                       {.cancelled = options.context.cancelled});
  if (!edged.body) return std::nullopt;
  Domain domain = edged_domain(edged, prepared.cloud, options.box, options.body.mesh.h);
  LevelSetReport report;
  report.fit.n_points = prepared.cloud.points.size();
  domain.facts = input_facts(prepared.report, report);
  domain.notices = prepared.report.notices;
  return right_mesh(std::move(domain), options);
}

/// The mesh with the sharp edges of the triangles; none if there are no such edges, or if it is not right.
std::optional<Mesh> mesh_with_edges(const SampledTriangles& triangles, const Options& options) {
  if (!may_keep_edges(options)) return std::nullopt;
  const Vec3 shift = middle_of(triangles.boundary);
  auto given = given_triangles(triangles.boundary, shift, sharp_edge_params(options.body.fit));
  auto body = edged_body(*given);
  if (!body) return std::nullopt;
  Domain domain =
      edged_domain(std::move(given), std::move(body), triangles.samples.cloud, shift, options.box, options.body.mesh.h);
  LevelSetReport report;
  report.fit.n_points = triangles.report.n_samples;
  domain.cloud_spacing = report.fit.cloud_spacing = triangles.report.spacing;
  domain.facts = input_facts(triangles.samples.report, report);
  domain.notices = triangles.samples.report.notices;
  return right_mesh(std::move(domain), options);
}

}  // namespace

FittedBody fit_body(OrientedPointCloud cloud, const Options& options) {
  return fit(prepare(given_cloud(std::move(cloud)), "points", options), nullptr, options);
}

FittedBody fit_body(TriangleMesh triangles, const Options& options) {
  return fit(sampled(std::move(triangles), options), options);
}

Mesh mesh_body(const FittedBody& body, const Options& options) {
  Domain domain = fitted_domain(body.psi, body.cloud, body.report, options.box);
  if (body.boundary)
    domain.triangles = given_triangles(*body.boundary, domain.shift, sharp_edge_params(options.body.fit));
  domain.facts = body.facts;
  domain.notices = body.notices;
  return mesh_of(std::move(domain), options);
}

Mesh mesh_body(OrientedPointCloud cloud, const Options& options) {
  PreparedCloud prepared = prepare(given_cloud(std::move(cloud)), "points", options);
  if (std::optional<Mesh> mesh = mesh_with_edges(prepared, options)) return std::move(*mesh);
  return mesh_body(fit(std::move(prepared), nullptr, options), options);
}

Mesh mesh_body(TriangleMesh triangles, const Options& options) {
  SampledTriangles body = sampled(std::move(triangles), options);
  if (std::optional<Mesh> mesh = mesh_with_edges(body, options)) return std::move(*mesh);
  return mesh_body(fit(std::move(body), options), options);
}

Mesh mesh_body(const PiecewiseDomain& body, const Options& options) {
  Domain domain = domain_in_box(options);
  set_body(domain, std::make_shared<const PiecewiseBody>(PiecewiseBody{body}));
  return mesh_of(std::move(domain), options);
}

Mesh mesh_body(const SharedFunction& psi, const Options& options) {
  Domain domain = domain_in_box(options);
  domain.formula = psi;
  return mesh_of(std::move(domain), options);
}

RegionBody region_body(std::string name, const SharedFunction& psi) {
  if (!psi.ref().has_hessian()) throw std::invalid_argument("regions: psi of " + name + " has no Hessian");
  return {.name = std::move(name), .psi = [psi](const Vec3& x, Vec3* gradient, Mat3* hessian) {
            const ImplicitFunctionRef f = psi.ref();
            Vec3 g;
            Mat3 H;
            const double value = hessian ? f.value(x, g, H) : gradient ? f.value(x, g) : f.value(x);
            if (gradient) *gradient = g;
            if (hessian) *hessian = H;
            return value;
          }};
}

RegionBody region_body(std::string name, const FittedBody& body) {
  const auto psi = std::make_shared<const LevelSet>(body.psi);
  RegionBody made = region_body(std::move(name), SharedFunction(psi));
  made.psi = [of_fit = std::move(made.psi), shift = body.report.shift](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    return of_fit(x - shift, gradient, hessian);
  };
  made.samples = body.cloud.points;
  Box box;
  for (const Vec3& x : made.samples) box.extend(x);
  made.box = box;
  return made;
}

}  // namespace umtet
