#include "pipeline/mesh_attempts.h"

#include <fmt/format.h>

#include <utility>

namespace umtet {
namespace {

// Down to .51 h, 7.5 times the tets.
constexpr int kAttempts = 4;
constexpr double kRefinement = .8;

bool may_improve(const MeshAttempt& a) {
  if (a.made()) return a.n_reasons() > 0;
  return a.result.status != UmStatus::EmptyDomain && a.result.status != UmStatus::DomainLeavesBackground;
}

bool is_worse(const MeshAttempt& a, const MeshAttempt& b) {
  return a.made() != b.made() ? b.made() : a.n_reasons() > b.n_reasons();
}

/// What is wrong with it first of all; empty if nothing is.
std::string complaint(const MeshAttempt& a) {
  if (!a.made()) return a.result.evidence.what;
  return a.n_reasons() > 0 ? a.measured.at("reasons").at(0).get<std::string>() : "";
}

}  // namespace

MeshAttempt best_attempt(const EdgeLength& choice, const std::function<MeshAttempt(double h)>& attempt,
                         const std::function<void(const std::string&)>& say) {
  MeshAttempt best = attempt(choice.h);
  bool go_on = may_improve(best);
  double h = choice.h;
  std::string why = complaint(best);
  for (int k = 1; k < kAttempts && go_on && h * kRefinement >= choice.least; ++k) {
    say(fmt::format("mesh: h = {:.4g} will not do ({}); trying {:.4g}", h, why, h * kRefinement));
    h *= kRefinement;
    MeshAttempt next = attempt(h);
    go_on = may_improve(next);
    why = complaint(next);
    if (!is_worse(next, best)) best = std::move(next);
  }
  if (best.h != h) say(fmt::format("mesh: h = {:.4g} will not do either ({}); keeping h = {:.4g}", h, why, best.h));
  return best;
}

}  // namespace umtet
