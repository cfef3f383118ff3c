#include "mesh/background/tilings/periodic_tiling.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

using Offset = std::array<int, 3>;
using Place = std::array<double, 3>;  // z, y, x: the order of the types

/// A point as its image in the cell at the origin and the cell it is in.
std::pair<Place, Offset> reduced(const Vec3& x, const Vec3& period) {
  std::pair<Place, Offset> result;
  for (int a = 0; a < 3; ++a) {
    const double cell = std::floor(x[a] / period[a]);
    result.second[a] = static_cast<int>(cell);
    result.first[2 - a] = x[a] - cell * period[a] + 0.;  // no negative zero
  }
  return result;
}

bool corner_less(const Tiling::Corner& a, const Tiling::Corner& b) {
  return std::tie(a.type, a.offset) < std::tie(b.type, b.offset);
}

}  // namespace

Tiling periodic_tiling(std::string name, const std::vector<std::array<Vec3, 4>>& tets, const Vec3& period,
                       const Vec3& unit) {
  std::map<Place, int> types;
  for (const auto& tet : tets) {
    for (const Vec3& x : tet) types.emplace(reduced(x, period).first, 0);
  }
  Tiling tiling;
  tiling.name = std::move(name);
  for (int a = 0; a < 3; ++a) tiling.period[a] = period[a] * unit[a];
  for (auto& [place, type] : types) {
    type = static_cast<int>(tiling.points.size());
    tiling.points.push_back({place[2] * unit[0], place[1] * unit[1], place[0] * unit[2]});
  }
  const auto less = [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), corner_less);
  };
  std::set<std::array<Tiling::Corner, 4>, decltype(less)> found(less);
  for (const auto& tet : tets) {
    const Offset home = reduced(.25 * (tet[0] + tet[1] + tet[2] + tet[3]), period).second;
    std::array<Tiling::Corner, 4> corners;
    for (int k = 0; k < 4; ++k) {
      const auto [place, cell] = reduced(tet[k], period);
      corners[k] = {types.at(place), {cell[0] - home[0], cell[1] - home[1], cell[2] - home[2]}};
      for (const int o : corners[k].offset) {
        if (std::abs(o) > 1) throw std::invalid_argument("tiling " + tiling.name + ": a tet wider than a period");
      }
    }
    std::sort(corners.begin(), corners.end(), corner_less);
    const auto place = [&](int k) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) {
        x[a] = tiling.points[corners[k].type][a] + corners[k].offset[a] * tiling.period[a];
      }
      return x;
    };
    const double v = volume6(place(0), place(1), place(2), place(3));
    if (v == 0) throw std::invalid_argument("tiling " + tiling.name + ": a flat tet");
    if (v < 0) std::swap(corners[2], corners[3]);
    found.insert(corners);
  }
  tiling.tets.assign(found.begin(), found.end());
  tiling.mean_edge = mean_edge(tiling, tables(tiling));
  return tiling;
}

}  // namespace umtet
