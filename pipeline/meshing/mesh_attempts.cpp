#include "pipeline/meshing/mesh_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
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

/// Another h may fold nothing; what is missing or too thin is as thin at an h that is hardly smaller.
bool may_improve_nearby(const MeshAttempt& a) {
  const auto& kinds = a.measured.places.kinds;
  return a.made() && std::all_of(kinds.begin(), kinds.end(), [](const PlaceReport::OfKind& k) {
           return is_settled(k) || k.kind == PlaceKind::Folded || k.kind == PlaceKind::Off;
         });
}

/// The edge lengths to try, one after the other.
class SmallerEdges {
 public:
  SmallerEdges(const EdgeLength& choice, double effort) : choice_(choice), effort_(effort), h_(choice.h), unit_(h_) {}

  /// What to try after this.
  std::optional<double> next(const MeshAttempt& last) {
    if (choice_.of_thin_parts && !is_begun_) {
      is_begun_ = true;
      return h_ = unit_ = *choice_.of_thin_parts;
    }
    const double nearby = kNearby * h_;
    if (n_smaller_ == 0 && !was_nearby_ && may_improve_nearby(last) && nearby >= choice_.least && may_try(nearby)) {
      was_nearby_ = true;
      return nearby;
    }
    const double smaller = std::max(kRefinement * h_, choice_.least);
    if (n_smaller_ == kRefinements || smaller > kWorthTrying * h_ || !may_try(smaller)) return std::nullopt;
    ++n_smaller_;
    return h_ = smaller;
  }

 private:
  bool may_try(double h) {
    spent_ += std::pow(unit_ / h, 3);
    return spent_ <= effort_;
  }

  const EdgeLength& choice_;
  const double effort_;
  double h_, unit_, spent_ = 1;
  int n_smaller_ = 0;
  bool is_begun_ = false, was_nearby_ = false;
};

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
  SmallerEdges smaller(choice, effort);
  MeshAttempt best = attempt(choice.h);
  bool keeps_last = true;
  double h = choice.h;
  std::string why = best.complaint();
  std::optional<double> next_h = may_improve(best) ? smaller.next(best) : std::nullopt;
  while (next_h) {
    say(fmt::format("h = {:.4g} will not do ({}); trying {:.4g}", h, why, *next_h));
    h = *next_h;
    MeshAttempt next = attempt(h);
    next_h = may_improve(next) ? smaller.next(next) : std::nullopt;
    why = next.complaint();
    keeps_last = !is_worse(next, best);
    if (keeps_last) best = std::move(next);
  }
  if (!keeps_last) say(fmt::format("h = {:.4g} will not do either ({}); keeping h = {:.4g}", h, why, best.h));
  return best;
}

MeshAttempt refined_attempt(double h, double effort,
                            const std::function<MeshAttempt(double h, const MeshAttempt* former)>& attempt,
                            const std::function<std::optional<double>(const MeshAttempt&)>& refine,
                            const std::function<void(const std::string&)>& say) {
  MeshAttempt last = attempt(h, nullptr), best;
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
    last = attempt(*next, &best);
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
