#include "mesh/fast/repair/detail/flip_candidates.h"

#include <algorithm>

namespace umtet::detail {
namespace {

// A flip that raises the star costs around by this much is not tried: one configuration that is not in the table costs
// 100 (StarCostTable), and no smoothing makes up for more than one.
constexpr float kMostCostOfFlip = 150;

}  // namespace

bool FlipCandidates::in_reach(std::int64_t v, std::size_t& n_evaluations) const {
  const Vec3 x = background_.position(v);
  const double h = links_.at(v).unit * background_.h();
  Vec3 g;
  const double value = psi_.value(x, g), norm = g.norm();
  ++n_evaluations;
  if (!(norm > 0)) return false;
  const double d = value / norm;
  if (!(d >= -classification_.reach_in * h && d <= params_.reach_out * h)) return false;
  return !(classification_.least_thickness > 0 &&
           is_thin(psi_, x - d / norm * g, g / norm, classification_.least_thickness, h, n_evaluations));
}

std::vector<FlipCandidates::Candidate> FlipCandidates::operator()(const std::array<std::int64_t, 4>& tet,
                                                                  std::size_t& n_evaluations) const {
  std::vector<std::int64_t> near(tet.begin(), tet.end());
  for (const std::int64_t v : tet) {
    links_.for_each(v, [&](std::int64_t w) { near.push_back(w); });
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<Candidate> list;
  for (const std::int64_t v : near) {
    if (v < 0 || v >= background_.n_vertices()) continue;  // beside a tet at the background boundary
    const LinkTopology& link = links_.at(v);
    const LinkMask m = links_.mask(v, inside_);
    if (!link.state(m).simple || background_.on_boundary(v) || !in_reach(v, n_evaluations)) continue;
    const auto cost = [&](const LinkTopology& of, LinkMask mask) {
      return mask == 0 ? 0.F : costs_(of.site, of.state(mask));
    };
    const auto bad = [](const LinkTopology& of, LinkMask mask) { return mask != 0 && !of.state(mask).manifold; };
    const bool is_inside = inside_.test(v);
    float change = is_inside ? cost(link, m) : -cost(link, m);
    int spots = is_inside ? bad(link, m) : -bad(link, m);
    for (int k = 0; k < link.n; ++k) {
      const std::int64_t w = links_.neighbour(v, k);
      if (inside_.test(w)) continue;
      const LinkTopology& t = links_.at(w);
      const LinkMask now = links_.mask(w, inside_), then = now ^ LinkMask { 1 } << link.back[k];
      change += cost(t, then) - cost(t, now);
      spots += bad(t, then) - bad(t, now);
    }
    if (spots <= 0 && change < kMostCostOfFlip) list.push_back({v, change});
  }
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  if (list.size() > static_cast<std::size_t>(params_.max_tries)) list.resize(params_.max_tries);
  return list;
}

}  // namespace umtet::detail
