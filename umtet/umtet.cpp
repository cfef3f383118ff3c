#include "umtet/umtet.h"

#include <stdexcept>

#include "body/scan/fitted_domain.h"
#include "body/scan/given_cloud.h"
#include "body/scan/level_set_fit.h"
#include "body/scan/sample_merging.h"
#include "body/search/best_mesh.h"
#include "body/search/mesh_maker.h"
#include "common/formatted.h"

namespace umtet {
namespace {

/// Throws what an attempt without a mesh is evidence of.
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

Mesh mesh_of(Domain domain, const Options& options) {
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
  for (Vec3& x : mesh.points) x += domain.shift;
  if (best.second) {
    mesh.curved = std::move(best.second->mesh);
    for (Vec3& x : mesh.curved->V) x += domain.shift;
  }
  mesh.verdict = judge(mesh.measures, options.verdict);
  return mesh;
}

}  // namespace

FittedBody fit_body(OrientedPointCloud cloud, const Options& options) {
  options.context.report("prepare", 0);
  PreparedCloud prepared = prepare_merged(given_cloud(std::move(cloud)), "points", options.body);
  LevelSetFit fit = fit_level_set(prepared.cloud, std::move(prepared.near), options.body, options.context);
  FittedBody body{.psi = std::move(fit.psi),
                  .cloud = std::move(prepared.cloud),
                  .report = std::move(fit.report),
                  .facts = {},
                  .notices = std::move(prepared.report.notices)};
  body.facts = input_facts(prepared.report, body.report);
  body.notices.insert(body.notices.end(), fit.notices.begin(), fit.notices.end());
  return body;
}

Mesh mesh_body(const FittedBody& body, const Options& options) {
  Domain domain = fitted_domain(body.psi, body.cloud, body.report, options.box);
  domain.facts = body.facts;
  domain.notices = body.notices;
  return mesh_of(std::move(domain), options);
}

Mesh mesh_body(OrientedPointCloud cloud, const Options& options) {
  return mesh_body(fit_body(std::move(cloud), options), options);
}

Mesh mesh_body(const SharedFunction& psi, const Options& options) {
  if (!options.box) throw std::invalid_argument("box: missing; a function needs one around the place where psi < 0");
  Domain domain;
  domain.formula = psi;
  domain.box = *options.box;
  domain.diagonal = options.box->diagonal().norm();
  return mesh_of(std::move(domain), options);
}

}  // namespace umtet
