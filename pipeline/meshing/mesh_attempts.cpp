#include "pipeline/meshing/mesh_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
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

/// What small places lack of thin parts, or was filled or cut for a manifold boundary, is as good as h can show. Folds
/// come and go with h.
bool is_settled(const PlaceReport::OfKind& k) {
  return k.n == k.n_small && (k.kind == PlaceKind::Filled || k.kind == PlaceKind::Cut || k.kind == PlaceKind::Thin);
}

bool may_improve(const MeshAttempt& a) {
  if (a.made()) {
    const auto& kinds = a.measured.places.kinds;
    return !a.reasons.empty() || !std::all_of(kinds.begin(), kinds.end(), is_settled);
  }
  return a.result.status != UmStatus::EmptyDomain && a.result.status != UmStatus::PsiNotFinite &&
         a.result.status != UmStatus::DomainLeavesBackground;
}

/// What to try after this, in this order.
std::vector<double> smaller(const MeshAttempt& first, const EdgeLength& choice, double effort) {
  std::vector<double> list;
  double h = choice.h;
  if (choice.of_thin_parts) list.push_back(h = *choice.of_thin_parts);
  const double unit = h;
  double spent = 1;
  const auto may_try = [&](double next) {
    spent += std::pow(unit / next, 3);
    return spent <= effort;
  };
  if (first.made() && kNearby * h >= choice.least && may_try(kNearby * h)) list.push_back(kNearby * h);
  for (int k = 0; k < kRefinements; ++k) {
    const double next = std::max(kRefinement * h, choice.least);
    if (next > kWorthTrying * h || !may_try(next)) break;
    list.push_back(h = next);
  }
  return list;
}

bool is_worse(const MeshAttempt& a, const MeshAttempt& b) {
  const auto rank = [](const MeshAttempt& x) { return std::tuple(!x.made(), x.reasons.size(), x.places.size()); };
  return rank(a) > rank(b);
}

}  // namespace

std::string MeshAttempt::complaint() const {
  if (!made()) return result.evidence.what;
  if (!reasons.empty()) return reasons.front();
  const std::size_t n = measured.places.n();
  if (n == 0) return "";
  return fmt::format("it is not faithful to psi = 0 at {} small place{}", n, n == 1 ? "" : "s");
}

MeshAttempt best_attempt(const EdgeLength& choice, double effort, const std::function<MeshAttempt(double h)>& attempt,
                         const std::function<void(const std::string&)>& say) {
  MeshAttempt best = attempt(choice.h);
  bool go_on = may_improve(best), keeps_last = true;
  double h = choice.h;
  std::string why = best.complaint();
  for (const double next_h : smaller(best, choice, effort)) {
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
