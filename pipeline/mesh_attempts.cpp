#include "pipeline/mesh_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace umtet {
namespace {

// Down to .51 h, 7.5 times the tets.
constexpr int kAttempts = 4;
constexpr double kRefinement = .8;
// A last h nearer to the one before than this is not worth a mesh.
constexpr double kWorthTrying = .95;

bool may_improve(const MeshAttempt& a) {
  if (a.made()) return a.n_reasons() > 0;
  return a.result.status != UmStatus::EmptyDomain && a.result.status != UmStatus::DomainLeavesBackground;
}

bool is_worse(const MeshAttempt& a, const MeshAttempt& b) {
  return a.made() != b.made() ? b.made() : a.n_reasons() > b.n_reasons();
}

}  // namespace

std::string MeshAttempt::complaint() const {
  if (!made()) return result.evidence.what;
  return n_reasons() > 0 ? measured.at("reasons").at(0).get<std::string>() : "";
}

MeshAttempt best_attempt(const EdgeLength& choice, const std::function<MeshAttempt(double h)>& attempt,
                         const std::function<void(const std::string&)>& say) {
  MeshAttempt best = attempt(choice.h);
  bool go_on = may_improve(best);
  double h = choice.h, next_h = std::max(kRefinement * h, choice.least);
  std::string why = best.complaint();
  bool keeps_last = true;
  for (int k = 1; k < kAttempts && go_on && next_h <= kWorthTrying * h; ++k) {
    say(fmt::format("mesh: h = {:.4g} will not do ({}); trying {:.4g}", h, why, next_h));
    h = next_h;
    next_h = std::max(kRefinement * h, choice.least);
    MeshAttempt next = attempt(h);
    go_on = may_improve(next);
    why = next.complaint();
    keeps_last = !is_worse(next, best);
    if (keeps_last) best = std::move(next);
  }
  if (!keeps_last) say(fmt::format("mesh: h = {:.4g} will not do either ({}); keeping h = {:.4g}", h, why, best.h));
  return best;
}

}  // namespace umtet
