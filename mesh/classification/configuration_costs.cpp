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
#include "mesh/core/quality_target.h"

namespace umtet {
namespace {

// Above every quality in the table, so that all configurations have a cost and good ones are told from better ones. In
// the bodies of ClassificationParams smoothing leaves 24 tets below .82 with .93 here, 45 with .915 and 12 with .95.
constexpr double kGoodInA15 = .93;

std::vector<ConfigurationQuality> qualities_of_z(const std::vector<LinkTopology>& links) {
  std::vector<ConfigurationQuality> qualities;
  for (const ConfigurationQuality& q : kA15ConfigurationQualities) {
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

ConfigurationCosts costs(std::vector<LinkTopology> links, std::span<const ConfigurationQuality> qualities, double good,
                         double repair_target, int repair_reach) {
  StarCostTable costs(links, qualities, good);
  return {std::move(links), good, std::move(costs), repair_target, repair_reach};
}

const ConfigurationCosts& costs_of_a15() {
  static const ConfigurationCosts made = costs(a15_links(), kA15ConfigurationQualities, kGoodInA15, kQualityTarget, 3);
  return made;
}

ConfigurationCosts costs_of_z() {
  std::vector<LinkTopology> links = link_topology(z_phase(), tables(z_phase()));
  const std::vector<ConfigurationQuality> qualities = qualities_of_z(links);
  return costs(std::move(links), qualities, kGoodInA15, kQualityTarget, 3);
}

}  // namespace

const ConfigurationCosts* configuration_costs(const Tiling& tiling) {
  if (tiling.name == a15().name) return &costs_of_a15();
  if (tiling.name == z_phase().name) {
    static const ConfigurationCosts made = costs_of_z();
    return &made;
  }
  // Patches of three edges are three and ten times as large as in A15, and mend no more than those of two.
  if (tiling.name == acute_slab().name) {
    static const ConfigurationCosts made =
        costs(link_topology(acute_slab(), tables(acute_slab())), kSlabConfigurationQualities, .936, .78, 2);
    return &made;
  }
  if (tiling.name == acute_cube().name) {
    static const ConfigurationCosts made = costs(links_of_cube(), kCubeConfigurationQualities, .847, .62, 2);
    return &made;
  }
  return nullptr;
}

const StarCostTable& a15_star_costs() { return costs_of_a15().costs; }

}  // namespace umtet
