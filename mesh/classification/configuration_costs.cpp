#include "mesh/classification/configuration_costs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "mesh/classification/tables/a15.h"
#include "mesh/classification/tables/cube.h"
#include "mesh/classification/tables/slab.h"

namespace umtet {
namespace {

// Above every quality in the table, so that all labellings have a price and good ones are told from better ones. In the
// bodies of LabelParams smoothing leaves 24 tets below .82 with .93 here, 45 with .915 and 12 with .95.
constexpr double kGoodInA15 = .93;

std::vector<LabelQuality> qualities_of_z(const std::vector<LinkTopology>& links) {
  std::vector<LabelQuality> qualities;
  for (const LabelQuality& q : kA15LabelQualities) {
    const int n = q.site == 0 ? 12 : 14;
    for (const int like : {n, n == 14 ? 15 : n}) {
      const auto link = std::find_if(links.begin(), links.end(), [&](const LinkTopology& l) { return l.n == like; });
      qualities.push_back({link->site, q.n_positive_faces, q.n_tets, q.quality});
    }
  }
  return qualities;
}

/// Edges of the cube are .5 to 3.3 h long: lengths are counted in the mean edge of each vertex. In h alone, tori and
/// ellipsoids of 100k tets end at min Q .588 instead of .613 and .619, before repair.
std::vector<LinkTopology> links_of_cube() {
  const Tiling& tiling = acute_cube();
  const TilingTables& all = tables(tiling);
  std::vector<LinkTopology> links = link_topology(tiling, all);
  for (std::size_t type = 0; type < links.size(); ++type) {
    double sum = 0;
    for (const Tiling::Corner& c : all.link[type]) {
      double square = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = tiling.points[static_cast<std::size_t>(c.type)][a] + c.offset[a] * tiling.period[a] -
                         tiling.points[type][a];
        square += d * d;
      }
      sum += std::sqrt(square);
    }
    links[type].unit = static_cast<float>(sum / links[type].n / tiling.mean_edge);
  }
  return links;
}

LabelPrices prices(std::vector<LinkTopology> links, std::span<const LabelQuality> qualities, double good,
                   double repair_target, int repair_reach) {
  LabelEnergies energies(links, qualities, good);
  return {std::move(links), good, std::move(energies), repair_target, repair_reach};
}

const LabelPrices& prices_of_a15() {
  static const LabelPrices made = prices(a15_links(), kA15LabelQualities, kGoodInA15, .82, 3);
  return made;
}

LabelPrices prices_of_z() {
  std::vector<LinkTopology> links = link_topology(z_phase(), tables(z_phase()));
  const std::vector<LabelQuality> qualities = qualities_of_z(links);
  return prices(std::move(links), qualities, kGoodInA15, .82, 3);
}

}  // namespace

const LabelPrices* label_prices(const Tiling& tiling) {
  if (tiling.name == a15().name) return &prices_of_a15();
  if (tiling.name == z_phase().name) {
    static const LabelPrices made = prices_of_z();
    return &made;
  }
  // Patches of three edges are three and ten times as large as in A15, and mend no more than those of two.
  if (tiling.name == acute_slab().name) {
    static const LabelPrices made =
        prices(link_topology(acute_slab(), tables(acute_slab())), kSlabLabelQualities, .936, .78, 2);
    return &made;
  }
  if (tiling.name == acute_cube().name) {
    static const LabelPrices made = prices(links_of_cube(), kCubeLabelQualities, .847, .62, 2);
    return &made;
  }
  return nullptr;
}

const LabelEnergies& a15_label_energies() { return prices_of_a15().energies; }

}  // namespace umtet
