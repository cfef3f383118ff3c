#include "pipeline/memory/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "body/fidelity/measure.h"
#include "body/pieces/zero_set_choice.h"
#include "body/scan/cloud_preparation.h"
#include "body/scan/fitted_domain.h"
#include "body/scan/level_set_fit.h"
#include "body/search/best_mesh.h"
#include "body/search/mesh_maker.h"
#include "body/sizing/too_thin.h"
#include "pipeline/case/memory.h"
#include "pipeline/case/thin_place_json.h"
#include "pipeline/domain/body_options.h"

namespace umtet {
namespace {

MeshingFailed too_thin(const MeshAttempt& best, const Vec3& shift) {
  return {fmt::format("{}\n  h = {:.3g} may show them", too_thin_text(best, shift), best.thin.h_needed()),
          {{"status", "TooThin"},
           {"h", best.h},
           {"h_needed", best.thin.h_needed()},
           {"too_thin", to_json(in_model(best.thin, shift), best.thin.h)}}};
}

}  // namespace

MeshingFailed failure(const UmResult& result, double h, const Vec3& shift) {
  const UmEvidence& e = result.evidence;
  const Vec3 at = e.where + shift;
  return {fmt::format("no mesh at h = {:.6g}: {}: {}", h, to_string(result.status), e.what),
          {{"status", to_string(result.status)},
           {"h", h},
           {"what", e.what},
           {"where", {at.x(), at.y(), at.z()}},
           {"background_vertex", e.background_vertex},
           {"background_tet", e.background_tet},
           {"count", e.count}}};
}

Reconstruction reconstruct(CloudFile file, const Parameters& parameters, const Watch& watch) {
  watch("prepare", 0);
  const BodyOptions options = body_options(parameters);
  PreparedCloud prepared = prepare_cloud(std::move(file), "points", options);
  LevelSetFit fit = fit_level_set(prepared.cloud, std::move(prepared.near), options, context_of(watch));
  std::vector<Message> notices = std::move(prepared.report.notices);
  notices.insert(notices.end(), fit.notices.begin(), fit.notices.end());
  const InputFacts facts = input_facts(prepared.report, fit.report);
  return {std::move(fit.psi), std::move(prepared.cloud), std::move(fit.report), facts, std::move(notices)};
}

Domain domain_of(const Reconstruction& r, const std::optional<Box>& box) {
  Domain domain = fitted_domain(r.psi, r.cloud, r.report, box);
  domain.facts = r.facts;
  return domain;
}

MeshAttempt make_mesh(Domain& domain, const Parameters& parameters, const Watch& watch, PartMesher* ranks) {
  const double allowed = ranks ? ranks->allowed_bytes(parameters) : allowed_bytes(parameters);
  MeshAttempt best = best_mesh(domain, body_options(parameters), allowed, context_of(watch), ranks);
  if (best.fell_through()) throw too_thin(best, domain.shift);
  if (!best.made()) throw failure(best.result, best.h, domain.shift);
  return best;
}

Certificate certificate_of(const Domain& domain, const UmResult& result, double h, const Parameters& parameters,
                           const Watch& watch) {
  watch("components", 0);
  const ZeroSetChoice pieces = choose_components(domain, h, polls_of(watch));
  watch("certify", 0);
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  return verdict_on(measure(domain, mesh, result, pieces, h, {}, polls_of(watch)).measures, parameters);
}

}  // namespace umtet
