#include "mesh/features/stratified_projection.h"

#include <algorithm>
#include <array>
#include <utility>

#include "mesh/core/max_min.h"

namespace umtet {
namespace {

using Role = ActiveLayer::Role;

// Parts of a step that are tried, longest first.
constexpr std::array<double, 4> kShares = {1, .5, .25, .125};
// As in backtracking_projection.cpp: in every third round, vertices that were held back are smoothed freely first.
constexpr int kRoundsPerDetour = 3;
// A vertex that is held back this often no longer insists on its own point of the curve: the nearest one will do.
constexpr int kRoundsForTarget = 8;
// So few vertices are put onto their strata one by one where that fails for all of them at once.
constexpr std::size_t kMostLeaps = 20;

/// Puts vertices onto their strata although tets invert, and untangles. The layer stays unchanged where that fails.
bool leap(PNormSmoother& smoother, ImplicitFunctionRef psi, const std::vector<Vec3>& target,
          const std::vector<int>& vertices, const SmoothingParams& params, const Context& context) {
  ActiveLayer& layer = smoother.layer();
  const std::vector<Vec3> before = layer.V;
  bool has_place = true;
  for (const int v : vertices) {
    Vec3 place = target[v];
    has_place =
        has_place && (place.allFinite() || layer.strata->foot(layer.stratum[v], layer.V[v], layer.h_at(v), place));
    if (has_place) layer.V[v] = place;
  }
  if (has_place) {
    smoother.enqueue_all();
    smoother.run(psi, params, context);
    SmoothingReport report;
    smoother.measure(report);
    if (report.tangled == 0) return true;
  }
  layer.V = before;
  return false;
}

}  // namespace

StratifiedProjectionReport project_onto_strata(PNormSmoother& smoother, ImplicitFunctionRef psi,
                                               const std::vector<Vec3>& target,
                                               const StratifiedProjectionParams& params, const Context& context) {
  StratifiedProjectionReport report;
  ActiveLayer& layer = smoother.layer();
  const double least_f = f_of_quality(params.least_quality);
  std::vector<int> under_way;
  for (std::size_t v = 0; v < layer.V.size(); ++v)
    if (layer.role[v] == Role::Boundary) under_way.push_back(static_cast<int>(v));
  for (const int v : under_way) layer.role[v] = Role::Fixed;
  SmoothingParams smoothing = params.smoothing;
  smoothing.max_sweeps = params.sweeps;

  const auto advance = [&](int v, double share) {
    const double h = layer.h_at(v);
    const Stratum& s = (*layer.strata)[layer.stratum[v]];
    Vec3 goal = layer.V[v];
    const bool has_target = target[v].allFinite() && (s.dimension == 0 || report.rounds <= kRoundsForTarget);
    if (has_target) {
      goal = target[v];
    } else if (!layer.strata->foot(layer.stratum[v], layer.V[v], h, goal)) {
      return false;
    }
    const Vec3 way = goal - layer.V[v];
    if (way.norm() <= 1e-10 * h) return true;
    const OneRing ring = smoother.ring(v);
    const double least = std::min(least_f, ring.f_here);
    for (const double part : kShares) {
      const Vec3 step = part * share * way;
      if (!(ring.min_f(step) >= least)) continue;
      const bool is_there = part * share == 1;
      layer.V[v] = is_there ? goal : Vec3(layer.V[v] + step);
      smoother.enqueue(v);
      return is_there;
    }
    return false;
  };

  while (report.rounds < params.max_rounds && !under_way.empty()) {
    context.poll();
    ++report.rounds;
    // The rest of the way in equal parts: 1 / 3 of it, then 1 / 2 of the rest, then all.
    const double share = 1. / std::max(1, params.passes - report.rounds + 1);
    std::vector<int> left;
    for (const int v : under_way) {
      if (advance(v, share)) {
        layer.role[v] = Role::Boundary;
      } else {
        left.push_back(v);
      }
    }
    under_way = std::move(left);
    const bool is_detour = report.rounds >= params.passes && report.rounds % kRoundsPerDetour == 0;
    for (const int v : under_way) layer.role[v] = is_detour ? Role::Inner : Role::Fixed;
    smoother.run(psi, smoothing, context);
    for (const int v : under_way) layer.role[v] = Role::Fixed;
  }
  for (const int v : under_way) layer.role[v] = Role::Boundary;
  if (!under_way.empty() && leap(smoother, psi, target, under_way, params.smoothing, context)) under_way.clear();
  if (under_way.size() <= kMostLeaps)
    std::erase_if(under_way, [&](int v) { return leap(smoother, psi, target, {v}, params.smoothing, context); });
  report.not_arrived = std::move(under_way);
  return report;
}

}  // namespace umtet
