#include "mesh/regions/detail/region_strata.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "mesh/regions/detail/vertex_places.h"

namespace umtet::detail {
namespace {

// Rounds in which a vertex of a curve goes halfway to the middle between its neighbours. Feet of a path that turns on
// the lattice are otherwise as near as a tenth of an edge, and in places in the wrong order.
constexpr int kSpreads = 10;

std::vector<Stratum> list_strata(const RegionDomain& domain, const RegionMesh& made, std::vector<int>& of_vertex) {
  std::vector<Stratum> list;
  std::map<RegionSet, int> known;  // sheets and curves
  of_vertex.assign(made.mesh.V.size(), -1);
  for (std::size_t v = 0; v < made.mesh.V.size(); ++v) {
    const int n = std::popcount(made.regions_at[v]);
    if (n < 2) continue;
    if (const auto at = known.find(made.regions_at[v]); at != known.end()) {
      of_vertex[v] = at->second;
      continue;
    }
    of_vertex[v] = static_cast<int>(list.size());
    Stratum s = stratum_of(domain, made.regions_at[v]);
    if (s.dimension == 0) {
      s.place = common_zero(domain, s.patches, made.mesh.V[v], made.h[v]);
    } else {
      known[made.regions_at[v]] = of_vertex[v];
    }
    list.push_back(std::move(s));
  }
  return list;
}

/// The two neighbours of each of these vertices on its curve, or at the corner at its end; -1 where there are not two.
std::vector<std::array<int, 2>> neighbours_on_curves(const RegionMesh& made, const std::vector<int>& on_curve) {
  std::vector<int> place(made.mesh.V.size(), -1);
  for (std::size_t k = 0; k < on_curve.size(); ++k) place[on_curve[k]] = static_cast<int>(k);
  std::vector<std::vector<int>> all(on_curve.size());
  for (const Tet& t : made.mesh.C)
    for (const int v : t) {
      if (place[v] < 0) continue;
      for (const int w : t)
        if (w != v && (made.regions_at[w] & made.regions_at[v]) == made.regions_at[v]) all[place[v]].push_back(w);
    }
  std::vector<std::array<int, 2>> two;
  for (std::vector<int>& list : all) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    two.push_back(list.size() == 2 ? std::array{list[0], list[1]} : std::array{-1, -1});
  }
  return two;
}

}  // namespace

RegionStrata::RegionStrata(const RegionDomain& domain, const RegionMesh& made)
    : strata(domain.boundary(), list_strata(domain, made, of_vertex)) {}

std::vector<Vec3> RegionStrata::targets(const RegionMesh& made) const {
  const std::size_t n = of_vertex.size();
  std::vector<Vec3> target(n, Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  std::vector<int> on_curve;
  for (std::size_t v = 0; v < n; ++v) {
    if (of_vertex[v] < 0) continue;
    const Stratum& s = strata[of_vertex[v]];
    if (s.dimension == 0) target[v] = s.place;
    Vec3 foot;
    if (s.dimension == 1 && strata.foot(of_vertex[v], made.mesh.V[v], made.h[v], foot)) {
      target[v] = foot;
      on_curve.push_back(static_cast<int>(v));
    }
  }
  const std::vector<std::array<int, 2>> neighbours = neighbours_on_curves(made, on_curve);
  for (int round = 0; round < kSpreads; ++round) {
    const std::vector<Vec3> before = target;
    for (std::size_t k = 0; k < on_curve.size(); ++k) {
      const auto [a, b] = neighbours[k];
      if (a < 0 || b < 0 || !before[a].allFinite() || !before[b].allFinite()) continue;
      const int v = on_curve[k];
      Vec3 foot;
      if (strata.foot(of_vertex[v], before[v] / 2 + (before[a] + before[b]) / 4, made.h[v], foot)) target[v] = foot;
    }
  }
  return target;
}

}  // namespace umtet::detail
