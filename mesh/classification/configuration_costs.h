#pragma once

#include <vector>

#include "mesh/background/link_topology.h"
#include "mesh/background/tiling.h"
#include "mesh/classification/star_cost_table.h"

namespace umtet {

/// What the choice of labels, and their repair, need to know of a tiling.
struct ConfigurationCosts {
  std::vector<LinkTopology> links;
  double good;  ///< of StarCostTable
  StarCostTable costs;
  double repair_target;  ///< what labels and smoothing reach on nearly every tet: no use to mend those above
  int repair_reach;      ///< of RepairParams, at most
};

/// Those of a15(), z_phase(), acute_slab() and acute_cube(), made once; null for another tiling.
///
/// Prices are measured (star_costs) but for Z, where a site's are those of A15 with as many neighbours: 12 and 14
/// neighbours are the Frank-Kasper polyhedra of A15 in Z too. Z's third kind, 15 neighbours, is priced like 14.
const ConfigurationCosts* configuration_costs(const Tiling& tiling);

/// That of a15().
const StarCostTable& a15_star_costs();

}  // namespace umtet
