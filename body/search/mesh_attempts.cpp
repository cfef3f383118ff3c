#include "body/search/mesh_attempts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "body/fidelity/input_judgement.h"
#include "common/formatted.h"

namespace umtet {
namespace {

// Whether a face folds depends also on how psi = 0 falls between the vertices of the background, which another h
// changes.
constexpr double kNearby = .985;
// Sizes below the h that shows a feature by this factor: the h of a place is measured where it is farthest off.
constexpr double kMargin = .97;
// A next h that is more than this share of the one before would make much the same mesh.
constexpr double kWorthTrying = .97;
// Meshes that are made anew as a whole after the first. With more effort than the default this many more.
constexpr int kRemade = 1, kRemadeWithEffort = 4;
// With more effort h falls by this much where nothing says how far it has to: .51 h after three times, with 7.5 times
// the tets.
constexpr double kRefinement = .8;

// Attempts with smaller edges where the one before failed.
constexpr int kMostRefinements = 4;

bool asks_for_more(double effort) { return effort > kDefaultEffort; }

/// A place that a smaller h, or smaller edges there, can mend. Small ones are named and left, unless the user spends
/// more effort; then those stay that are as good as h can show, because folds come and go with h and gaps do not.
bool is_left(const MeshDefect& defect, double effort) {
  if (!is_small(defect)) return false;
  return !asks_for_more(effort) || defect.kind == DefectKind::Filled || defect.kind == DefectKind::Cut ||
         defect.kind == DefectKind::Thin;
}

/// psi has so much that no sample supports that the mesh fails, and the mesh only repeats it: no other mesh of the same
/// psi passes.
bool fails_by_guesses(const MeshAttempt& a) {
  const bool repeats_psi =
      a.measured.mesh.boundary.euler_characteristic >= a.measured.domain.euler_characteristic_of_kept_components;
  const std::vector<InputDefect> defects = input_defects(a.measured);
  return std::any_of(defects.begin(), defects.end(), [&](const InputDefect& d) {
    return !d.is_small && (d.kind == InputDefectKind::Guessed || d.kind == InputDefectKind::Sides ||
                           (d.kind == InputDefectKind::Handles && repeats_psi));
  });
}

/// Another h may fold nothing; what is missing or too thin is as thin at an h that is hardly smaller.
bool may_improve_nearby(const MeshAttempt& a, double effort) {
  return a.made() && std::all_of(a.defects.begin(), a.defects.end(), [&](const MeshDefect& p) {
           return is_left(p, effort) || p.kind == DefectKind::Folded || p.kind == DefectKind::Off;
         });
}

/// The h that is forecast to show all that an attempt does not; none where a defect has nothing thin to explain it, or
/// where the mesh fails without a defect that has a place.
std::optional<double> h_that_shows(const MeshAttempt& a, double effort) {
  if (!a.made()) return a.thin.empty() ? std::nullopt : std::optional(kMargin * a.thin.h_needed());
  std::optional<double> h;
  for (const MeshDefect& defect : a.defects) {
    if (is_left(defect, effort)) continue;
    if (!defect.h_needed) return std::nullopt;
    h = std::min(h.value_or(*defect.h_needed), *defect.h_needed);
  }
  return h ? std::optional(kMargin * *h) : std::nullopt;
}

bool is_worse(const MeshAttempt& a, const MeshAttempt& b) {
  const auto rank = [](const MeshAttempt& x) { return std::tuple(!x.made(), x.reasons.size(), x.defects.size()); };
  return rank(a) > rank(b);
}

}  // namespace

bool may_improve(const MeshAttempt& a, double effort) {
  if (a.made()) {
    if (!asks_for_more(effort) && fails_by_guesses(a)) return false;
    return !a.reasons.empty() ||
           !std::all_of(a.defects.begin(), a.defects.end(), [&](const MeshDefect& p) { return is_left(p, effort); });
  }
  return a.result.status != UmStatus::EmptyDomain && a.result.status != UmStatus::PsiNotFinite &&
         a.result.status != UmStatus::DomainLeavesBackground;
}

std::string MeshAttempt::complaint() const {
  if (!made()) return result.evidence.what;
  if (!reasons.empty()) return reasons.front();
  const std::size_t n = measured.defects.n();
  if (n == 0) return "";
  return formatted("it has %zu small defect%s", n, n == 1 ? "" : "s");
}

AttemptsWithOneH::AttemptsWithOneH(const EdgeLength& choice, double effort, std::function<void(const std::string&)> say)
    : choice_(choice),
      effort_(effort),
      say_(std::move(say)),
      next_h_(choice.h),
      left_(asks_for_more(effort) ? kRemadeWithEffort : kRemade),
      h_(choice.h),
      unit_(choice.h) {}

void AttemptsWithOneH::add(MeshAttempt last) {
  const double h = *next_h_;
  next_h_ = may_improve(last, effort_) ? h_after(last) : std::nullopt;
  const std::string why = last.complaint();
  const bool keeps_last = !best_ || !is_worse(last, *best_);
  if (keeps_last) best_ = std::move(last);
  if (next_h_) {
    say_(formatted("h = %.4g will not do (%s); trying %.4g", h, why.c_str(), *next_h_));
  } else if (!keeps_last) {
    say_(formatted("h = %.4g will not do either (%s); keeping h = %.4g", h, why.c_str(), best_->h));
  }
}

std::optional<double> AttemptsWithOneH::h_after(const MeshAttempt& last) {
  if (left_-- == 0) return std::nullopt;
  // Thin parts that noise hides do not show at any h: samples are as far off as they are thick.
  if (choice_.of_thin_parts && !is_begun_ && asks_for_more(effort_)) {
    is_begun_ = true;
    return h_ = unit_ = *choice_.of_thin_parts;
  }
  const double nearby = kNearby * h_;
  if (!was_nearby_ && !is_smaller_ && may_improve_nearby(last, effort_) && nearby >= choice_.least && may_try(nearby)) {
    was_nearby_ = true;
    return nearby;
  }
  std::optional<double> smaller = h_that_shows(last, effort_);
  if (choice_.of_thin_parts && !is_begun_) smaller.reset();
  if (asks_for_more(effort_)) smaller = std::min(smaller.value_or(kRefinement * h_), kRefinement * h_);
  if (!smaller) return std::nullopt;
  *smaller = std::max(*smaller, choice_.least);
  if (*smaller > kWorthTrying * h_ || !may_try(*smaller)) return std::nullopt;
  is_smaller_ = true;
  return h_ = *smaller;
}

bool AttemptsWithOneH::may_try(double h) {
  const double spent = spent_ + std::pow(unit_ / h, 3);
  if (spent > effort_) return false;
  spent_ = spent;
  return true;
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
    const bool may_try = round < kMostRefinements && may_improve(last, effort) && allowed >= tets_of(last);
    if (may_try) next = refine(last);
    const std::string why = last.complaint();
    if (!has_best || !is_worse(last, best)) {
      best = std::move(last);
      has_best = true;
    } else if (!next) {
      say(formatted("smaller edges will not do either (%s); keeping those of %.0f tets", why.c_str(), tets_of(best)));
    }
    if (!next) return best;
    say(formatted("the mesh will not do (%s); trying smaller edges where it failed", why.c_str()));
    last = attempt(*next, &best);
  }
}

std::vector<SizeSource> finer_where_it_failed(const MeshAttempt& a, const Vec3& shift, double effort) {
  // So far around a place edges are smaller, in those that were asked for there: tets at it have neighbours.
  constexpr double kAround = 2;
  std::vector<SizeSource> finer;
  const auto add = [&](const Vec3& x, double size) {
    const double asked = a.sizes->at(x);
    finer.push_back({x, asked / 2, size / 2 + kAround * asked});
  };
  if (!a.made()) add(a.result.evidence.where, 0);
  for (const MeshDefect& defect : a.defects) {
    if (is_left(defect, effort)) continue;
    const Vec3 x = defect.where - shift;
    add(x, defect.size_over_h * a.sizes->at(x));
  }
  return finer;
}

}  // namespace umtet
