#include "pipeline/meshing/mesh_maker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "pipeline/case/exit_code.h"
#include "pipeline/meshing/edge_length.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/meshing/mesh_measures.h"
#include "pipeline/meshing/second_order.h"
#include "pipeline/meshing/too_thin.h"
#include "pipeline/stages/stages.h"

namespace umtet {
namespace {

// Another h is tried for the number of tets that was asked for when it is missed by more than this.
constexpr double kTetsTolerance = .1;
// So often; then the h that missed it least is taken.
constexpr int kMostMisses = 4;
// Pieces of psi = 0 are looked for on a grid of h and, where there is none, on so many grids twice as fine as the one
// before.
constexpr int kFinerGrids = 3;

void take(std::optional<std::string> reason, std::vector<std::string>& reasons) {
  if (reason) reasons.push_back(std::move(*reason));
}

}  // namespace

MeshMaker::MeshMaker(Domain& domain, const Parameters& parameters, MeshWatch watch)
    : domain_(domain), parameters_(parameters), watch_(std::move(watch)), params_(um_params(parameters)) {}

void MeshMaker::begin(const char* step) const {
  if (watch_.begins) watch_.begins(step);
}

bool MeshMaker::observe(const UmProgress& p) {
  const std::string_view step = p.step;
  if (step == "submesh" && !may_miss_) {
    const double ratio = static_cast<double>(p.n_tets) / static_cast<double>(parameters_.integer("mesh.tets"));
    if (std::abs(ratio - 1) > kTetsTolerance) {
      missed_by_ = ratio;
      return false;
    }
  }
  if (parameters_.flag("mesh.keep_iterates") && step == "project" && p.sweep == p.n_sweeps) iterates_.push_back(*p.V);
  return !watch_.progress || watch_.progress(p);
}

const ZeroSetChoice& MeshMaker::pieces_at(double h) {
  domain_.limit_detail(h);
  if (!pieces_ || pieces_->first != h) {
    begin("components");
    // A body thinner than the grid may have no node inside.
    for (int halvings = 0; halvings <= kFinerGrids; ++halvings) {
      pieces_.emplace(h, choose_components(domain_, std::ldexp(h, -halvings), watch_.keep_going));
      if (!pieces_->second.topology.components.empty()) break;
    }
  }
  return pieces_->second;
}

UmResult MeshMaker::make(const BackgroundMesh& background, const ZeroSetChoice& pieces) {
  UmParams params = params_;
  // The full loop would mesh every piece; crawling starts from the ones to keep.
  if (!pieces.dropped.empty()) params.search = SubmeshSearch::Crawl;
  if (pieces.seeds.empty() && !pieces.dropped.empty()) {
    throw MeshingImpossible("psi = 0 is nowhere near the samples:\n  no " + pieces.dropped.front());
  }
  if (watch_.detail) {
    watch_.detail(fmt::format("h = {:.6g}, background of {} tets, psi = 0 in {} pieces", background.h(),
                              background.n_tets(), pieces.topology.components.size()));
  }
  begin("submesh");
  UmResult result = universal_mesh(
      background, domain_.psi(), params, [this](const UmProgress& p) { return observe(p); }, pieces.seeds);
  round_to_file(result, domain_.shift);
  return result;
}

MeshAttempt MeshMaker::attempt(const BackgroundMesh& background, double h) {
  MeshAttempt a;
  a.h = h;
  iterates_.clear();
  const ZeroSetChoice& pieces = pieces_at(h);
  a.thin = find_thin_places(domain_, pieces, h, watch_.keep_going);
  if (!a.thin.empty() && watch_.detail) {
    watch_.detail(fmt::format("{} places are thinner than h = {:.4g} can show for certain:\n{}", a.thin.places.size(),
                              h, described(a.thin, domain_.shift)));
  }
  for (const std::string& reason : pieces.dropped) {
    if (watch_.say) watch_.say("left out a " + reason);
  }
  a.result = make(background, pieces);
  a.iterates = std::move(iterates_);
  begin("certify");  // stops here if what watches has ended the run
  if (!a.made()) return a;
  a.measured = measure(domain_, a.result, pieces, h, watch_.keep_going);
  a.measured.resolution.too_thin = in_model(a.thin, domain_.shift);
  take(lost_reason(domain_, a.result, a.thin, watch_.keep_going), a.measured.reasons);
  take(deviation_reason(parameters_.real("mesh.max_deviation"), a.measured.mesh), a.measured.reasons);
  curve(a);
  return a;
}

void MeshMaker::curve(MeshAttempt& a) const {
  const std::int64_t order = parameters_.integer("mesh.order");
  a.measured.order = order;
  if (order < 2) return;
  begin("second order");
  a.second = curved_mesh(domain_, a.result, a.h, params_.closest_point, watch_.keep_going);
  a.measured.second_order = measure_second_order(domain_, a.result, *a.second, a.h, watch_.keep_going);
  for (std::string& reason : failures(*a.measured.second_order)) a.measured.reasons.push_back(std::move(reason));
}

/// The estimate behind mesh.tets knows the shape from a few thousand samples. Where it is far off, the number of tets
/// at one h gives the next, before anything is moved. Few tets jump with h, to either side of the number asked for.
MeshAttempt MeshMaker::attempt_for_tets(double h, const std::function<BackgroundMesh(double h)>& background) {
  may_miss_ = parameters_.integer("mesh.tets") == 0;
  double nearest = h, least_miss = std::numeric_limits<double>::infinity();
  std::optional<double> makes_more, makes_less;
  for (int k = 1;; ++k) {
    missed_by_ = 0;
    MeshAttempt a = attempt(background(h), h);
    if (missed_by_ == 0) return a;
    if (const double miss = std::abs(std::log(missed_by_)); miss < least_miss) nearest = h, least_miss = miss;
    (missed_by_ > 1 ? makes_more : makes_less) = h;
    may_miss_ = k == kMostMisses;
    const double better = may_miss_                  ? nearest
                          : makes_more && makes_less ? std::sqrt(*makes_more * *makes_less)
                                                     : h * std::cbrt(missed_by_);
    if (watch_.say) {
      watch_.say(fmt::format("h = {:.4g} makes {:.2g} times the tets asked for; trying {:.4g}", h, missed_by_, better));
    }
    h = std::max(better, least_h_in_file(domain_));
  }
}

MeshAttempt MeshMaker::best(const EdgeLength& choice, const std::function<BackgroundMesh(double h)>& background) {
  return best_attempt(
      choice, [&](double h) { return attempt_for_tets(h, background); },
      [this](const std::string& line) {
        if (watch_.say) watch_.say(line);
      });
}

bool MeshMaker::is_refused_as_thin(const MeshAttempt& a) const {
  if (a.thin.empty() || parameters_.flag("mesh.allow_thin") || a.is_right()) return false;
  return !a.made() || !is_only_coarse(a.measured);
}

std::string too_thin_text(const MeshAttempt& a, const Vec3& shift) {
  const std::size_t n = a.thin.places.size();
  return fmt::format("h = {:.4g} is too large: {}; {} place{} thinner than it can show\n{}", a.h, a.complaint(), n,
                     n == 1 ? " is" : "s are", described(a.thin, shift));
}

}  // namespace umtet
