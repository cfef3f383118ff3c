#include "pipeline/meshing/mesh_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace umtet {
namespace {

// Whether a face folds depends also on how psi = 0 falls between the vertices of the background, which another h
// changes. So one that is hardly smaller is tried before .8 h, which makes twice the tets.
constexpr double kNearby = .985;
// The last of them is .51 h, with 7.5 times the tets.
constexpr int kRefinements = 3;
constexpr double kRefinement = .8;
// A last h that is more than this share of the one before is not tried: it would make much the same mesh.
constexpr double kWorthTrying = .95;

bool may_improve(const MeshAttempt& a) {
  if (a.made()) return a.n_reasons() > 0;
  return a.result.status != UmStatus::EmptyDomain && a.result.status != UmStatus::PsiNotFinite &&
         a.result.status != UmStatus::DomainLeavesBackground;
}

/// What to try after this, in this order.
std::vector<double> smaller(const MeshAttempt& first, const EdgeLength& choice) {
  std::vector<double> list;
  double h = choice.h;
  if (choice.of_thin_parts) list.push_back(h = *choice.of_thin_parts);
  if (first.made() && kNearby * h >= choice.least) list.push_back(kNearby * h);
  for (int k = 0; k < kRefinements; ++k) {
    const double next = std::max(kRefinement * h, choice.least);
    if (next > kWorthTrying * h) break;
    list.push_back(h = next);
  }
  return list;
}

bool is_worse(const MeshAttempt& a, const MeshAttempt& b) {
  return a.made() != b.made() ? b.made() : a.n_reasons() > b.n_reasons();
}

}  // namespace

std::string MeshAttempt::complaint() const {
  if (!made()) return result.evidence.what;
  return n_reasons() > 0 ? measured.reasons.front() : "";
}

MeshAttempt best_attempt(const EdgeLength& choice, const std::function<MeshAttempt(double h)>& attempt,
                         const std::function<void(const std::string&)>& say) {
  MeshAttempt best = attempt(choice.h);
  bool go_on = may_improve(best), keeps_last = true;
  double h = choice.h;
  std::string why = best.complaint();
  for (const double next_h : smaller(best, choice)) {
    if (!go_on) break;
    say(fmt::format("h = {:.4g} will not do ({}); trying {:.4g}", h, why, next_h));
    h = next_h;
    MeshAttempt next = attempt(h);
    go_on = may_improve(next);
    why = next.complaint();
    keeps_last = !is_worse(next, best);
    if (keeps_last) best = std::move(next);
  }
  if (!keeps_last) say(fmt::format("h = {:.4g} will not do either ({}); keeping h = {:.4g}", h, why, best.h));
  return best;
}

}  // namespace umtet
