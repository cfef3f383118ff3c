#include "mesh/classification/star_cost_table.h"

namespace umtet {
namespace {

constexpr float kScale = 1e4F;  // .1 below good is 100: the unit of all costs
// A configuration that the fit never met, or met too seldom to say.
constexpr float kUnknown = 100;
// Worse than all the rings a flip can spoil.
constexpr float kNotManifold = 1000;

}  // namespace

void StarCostTable::make_rows(const std::vector<LinkTopology>& links) {
  for (const LinkTopology& link : links) {
    const auto site = static_cast<std::size_t>(link.site);
    if (site >= of_site_.size()) of_site_.resize(site + 1);
    of_site_[site].row = std::max(of_site_[site].row, link.triangles.size() + 1);
  }
  for (OfSite& of : of_site_) of.cost.assign(of.row * of.row, kUnknown);
}

StarCostTable::StarCostTable(const std::vector<LinkTopology>& links, std::span<const ConfigurationQuality> qualities,
                             double good)
    : not_manifold_(kNotManifold) {
  make_rows(links);
  for (const ConfigurationQuality& q : qualities) {
    OfSite& of = of_site_[static_cast<std::size_t>(q.site)];
    const float lack = std::max(0.F, static_cast<float>(good) - static_cast<float>(q.quality));
    of.cost[static_cast<std::size_t>(q.n_positive_faces) * of.row + static_cast<std::size_t>(q.n_tets)] =
        std::min(kUnknown, kScale * lack * lack);
  }
}

StarCostTable::StarCostTable(const std::vector<LinkTopology>& links, const std::function<float(int, int)>& cost)
    : not_manifold_(kNotManifold) {
  make_rows(links);
  for (OfSite& of : of_site_) {
    for (std::size_t k = 0; k < of.cost.size(); ++k) {
      of.cost[k] = std::min(kUnknown, cost(static_cast<int>(k / of.row), static_cast<int>(k % of.row)));
    }
  }
}

}  // namespace umtet
