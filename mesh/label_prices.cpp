#include "mesh/label_prices.h"

#include <algorithm>

namespace umtet {
namespace {

LabelPrices prices_of_z() {
  LabelPrices prices{link_topology(z_phase(), tables(z_phase())), {}};
  std::vector<LabelQuality> qualities;
  for (const LabelQuality& q : a15_label_qualities()) {
    const int n = q.site == 0 ? 12 : 14;
    for (const int like : {n, n == 14 ? 15 : n}) {
      const auto link =
          std::find_if(prices.links.begin(), prices.links.end(), [&](const LinkTopology& l) { return l.n == like; });
      qualities.push_back({link->site, q.n_positive_faces, q.n_tets, q.quality});
    }
  }
  prices.energies = label_energies(prices.links, qualities);
  return prices;
}

}  // namespace

const LabelPrices* label_prices(const Tiling& tiling) {
  if (tiling.name == a15().name) {
    static const LabelPrices prices{a15_links(), a15_label_energies()};
    return &prices;
  }
  if (tiling.name == z_phase().name) {
    static const LabelPrices prices = prices_of_z();
    return &prices;
  }
  return nullptr;
}

}  // namespace umtet
