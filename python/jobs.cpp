#include "python/jobs.h"

#include <fmt/format.h>

#include <utility>

#include "pipeline/background_choice.h"
#include "pipeline/certificate_json.h"
#include "pipeline/cloud_preparation.h"
#include "pipeline/edge_length.h"
#include "pipeline/made_mesh.h"
#include "pipeline/memory.h"
#include "pipeline/mesh_measures.h"
#include "pipeline/second_order.h"
#include "pipeline/stages.h"
#include "pipeline/too_thin.h"
#include "pipeline/zero_set_choice.h"
#include "reconstruct/cloud_survey.h"

namespace umtet::python {
namespace {

KeepGoing polls(const Watch& watch) {
  return [&watch] {
    watch(nullptr, 0);
    return true;
  };
}

class Mesher {
 public:
  Mesher(Domain& domain, const Parameters& parameters, const Watch& watch)
      : domain_(domain), parameters_(parameters), watch_(watch), choice_(parameters, domain) {
    domain.complement = parameters.flag("mesh.complement");
  }

  MeshAttempt operator()() {
    watch_("size", 0);
    const EdgeLength h = edge_length();
    MeshAttempt best = best_attempt(
        h, [this](double tried) { return attempt(tried); }, [](const std::string&) {});
    const bool refuses_thin = !best.thin.empty() && !parameters_.flag("mesh.allow_thin");
    if (refuses_thin && !best.is_right() && !(best.made() && is_only_coarse(best.measured))) refuse_thin(best);
    if (!best.made()) throw failure(best.result, best.h, domain_.shift);
    return best;
  }

 private:
  EdgeLength edge_length() const;
  std::int64_t n_tets() const;
  MeshAttempt attempt(double h);
  void curve(MeshAttempt& a) const;
  [[noreturn]] void refuse_thin(const MeshAttempt& best) const;

  Domain& domain_;
  const Parameters& parameters_;
  const Watch& watch_;
  const BackgroundChoice choice_;
};

// Foretelling the number of tets takes a million values of psi, whatever h is: some ten seconds of a Python callable.
// Where h is given it is left out, and memory is asked for as many as are allowed.
EdgeLength Mesher::edge_length() const {
  if (choice_.own_h()) return {*choice_.own_h(), *choice_.own_h()};
  const double h = parameters_.real("mesh.h");
  if (domain_.function && h >= least_h_in_file(domain_) && h > 0) return {h, h};
  return choose_edge_length(domain_, parameters_, polls(watch_));
}

std::int64_t Mesher::n_tets() const {
  return domain_.function ? parameters_.integer("mesh.max_tets") : parameters_.integer("mesh.tets");
}

MeshAttempt Mesher::attempt(double h) {
  MeshAttempt a;
  a.h = h;
  domain_.limit_detail(h);
  const BackgroundMesh background = choice_.make(domain_, h, n_tets(), allowed_bytes(parameters_));
  watch_("components", 0);
  const ZeroSetChoice pieces = choose_components(domain_, h, polls(watch_));
  if (pieces.seeds.empty() && !pieces.dropped.empty()) {
    throw MeshingFailed("psi = 0 is nowhere near the samples: no " + pieces.dropped.front(), {{"h", h}});
  }
  a.thin = find_thin_places(domain_, pieces, h, polls(watch_));
  UmParams params = um_params(parameters_);
  if (!pieces.dropped.empty()) params.search = SubmeshSearch::Crawl;
  a.result = universal_mesh(
      background, domain_.psi(), params,
      [this](const UmProgress& p) {
        watch_(p.step, static_cast<double>(p.pass) / std::max(p.n_passes, 1));
        return true;
      },
      pieces.seeds);
  round_to_file(a.result, domain_.shift);
  if (!a.made()) return a;
  watch_("certify", 0);
  a.measured = measure(domain_, a.result, pieces, h, polls(watch_));
  check_lost(domain_, a.result, a.thin, a.measured, polls(watch_));
  curve(a);
  check_deviation(parameters_.real("mesh.max_deviation"), a.measured);
  return a;
}

void Mesher::curve(MeshAttempt& a) const {
  a.measured["order"] = parameters_.integer("mesh.order");
  a.measured["second_order"] = nullptr;
  if (parameters_.integer("mesh.order") < 2) return;
  watch_("second order", 0);
  a.second = curved_mesh(domain_, a.result, a.h, um_params(parameters_).closest_point, polls(watch_));
  measure_second_order(domain_, a.result, *a.second, a.h, a.measured, polls(watch_));
}

void Mesher::refuse_thin(const MeshAttempt& best) const {
  throw MeshingFailed(fmt::format("h = {:.4g} is too large: {}; {} places are thinner than it can show\n{}\n"
                                  "  h = {:.3g} may show them; allow_thin=True keeps the mesh nevertheless",
                                  best.h, best.complaint(), best.thin.places.size(),
                                  described(best.thin, domain_.shift), best.thin.h_needed()),
                      {{"status", "TooThin"},
                       {"h", best.h},
                       {"h_needed", best.thin.h_needed()},
                       {"too_thin", to_json(best.thin, domain_.shift)}});
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

Reconstruction reconstruct(OrientedPointCloud cloud, const Parameters& parameters, const Watch& watch) {
  Reconstruction made;
  SsdParams params = ssd_params(parameters);
  params.max_memory = allowed_bytes(parameters);
  CloudFile file;
  file.report.format = "arrays";
  file.report.n_points = cloud.points.size();
  file.cloud = std::move(cloud);
  watch("prepare", 0);
  PreparedCloud prepared = prepare_cloud(std::move(file), "points", parameters);
  made.notices = std::move(prepared.notices);
  Domain& domain = made.domain;
  domain.cloud = std::move(prepared.cloud);
  domain.shift = far_origin_shift(domain.cloud);
  Box box;
  for (Vec3& x : domain.cloud.points) {
    x -= domain.shift;
    box.extend(x);
  }
  domain.diagonal = box.diagonal().norm();
  watch("noise", 0);
  const double noise = parameters.real("reconstruct.noise");
  made.noise = params.noise =
      noise >= 0 ? noise : noise_along_normals(domain.cloud, NeighbourTree(domain.cloud.points));
  SsdFit fit = fit_ssd(
      domain.cloud, params,
      [&](const char* step, double fraction) {
        watch(step, fraction);
        return true;
      },
      prepared.near.nearest.empty() ? nullptr : &prepared.near);
  require_outward_normals(fit.report);
  made.report = std::move(fit.report);
  domain.samples = std::make_shared<const SampleDistance>(domain.cloud.points);
  domain.cloud_spacing = made.report.cloud_spacing;
  domain.box = fit.psi.domain();
  domain.fitted = fit.psi;
  domain.level_set = std::move(fit.psi);
  return made;
}

MeshAttempt make_mesh(Domain& domain, const Parameters& parameters, const Watch& watch) {
  return Mesher(domain, parameters, watch)();
}

Json certificate_of(const Domain& domain, const UmResult& result, double h, const Parameters& parameters,
                    const Watch& watch) {
  watch("components", 0);
  const ZeroSetChoice pieces = choose_components(domain, h, polls(watch));
  watch("certify", 0);
  return verdict_on(measure(domain, result, pieces, h, polls(watch)), parameters);
}

}  // namespace umtet::python
