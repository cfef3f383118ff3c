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

// Attempts with smaller edges where the one before failed.
constexpr int kMostRefinements = 4;

/// What small places lack of thin parts, or was filled or cut for a manifold boundary, is as good as h can show. Folds
/// come and go with h.
bool is_as_good_as_h(PlaceKind kind) {
  return kind == PlaceKind::Filled || kind == PlaceKind::Cut || kind == PlaceKind::Thin;
}

bool is_settled(const PlaceReport::OfKind& k) { return k.n == k.n_small && is_as_good_as_h(k.kind); }

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

MeshAttempt refined_attempt(double h, double effort, const std::function<MeshAttempt(double h)>& attempt,
                            const std::function<std::optional<double>(const MeshAttempt&)>& refine,
                            const std::function<void(const std::string&)>& say) {
  MeshAttempt last = attempt(h), best;
  const auto tets_of = [](const MeshAttempt& a) { return static_cast<double>(a.result.submesh.mesh.C.size()); };
  double allowed = effort * tets_of(last);
  bool has_best = false;
  for (int round = 0;; ++round) {
    allowed -= tets_of(last);
    std::optional<double> next;
    const bool may_try = round < kMostRefinements && may_improve(last) && allowed >= tets_of(last);
    if (may_try) next = refine(last);
    const std::string why = last.complaint();
    if (!has_best || !is_worse(last, best)) {
      best = std::move(last);
      has_best = true;
    } else if (!next) {
      say(fmt::format("smaller edges will not do either ({}); keeping those of {} tets", why, tets_of(best)));
    }
    if (!next) return best;
    say(fmt::format("the mesh will not do ({}); trying smaller edges where it failed", why));
    last = attempt(*next);
  }
}

std::vector<SizeSource> finer_where_it_failed(const MeshAttempt& a, const Vec3& shift) {
  // So far around a place edges are smaller, in those that were asked for there: tets at it have neighbours.
  constexpr double kAround = 2;
  std::vector<SizeSource> finer;
  const auto add = [&](const Vec3& x, double size) {
    const double asked = a.sizes->at(x);
    finer.push_back({x, asked / 2, size / 2 + kAround * asked});
  };
  if (!a.made()) add(a.result.evidence.where, 0);
  for (const MeshPlace& place : a.places) {
    if (is_small(place) && is_as_good_as_h(place.kind)) continue;
    const Vec3 x = place.where - shift;
    add(x, place.size_over_h * a.sizes->at(x));
  }
  return finer;
}

}  // namespace umtet
