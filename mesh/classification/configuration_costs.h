#pragma once

#include <vector>

#include "mesh/classification/star_cost_table.h"
#include "mesh/background/link_topology.h"
#include "mesh/background/tiling.h"

namespace umtet {

/// What the choice of labels, and their repair, need to know of a tiling.
struct LabelPrices {
  std::vector<LinkTopology> links;
  double good;  ///< of LabelEnergies
  LabelEnergies energies;
  double repair_target;  ///< what labels and smoothing reach on nearly every tet: no use to mend those above
  int repair_reach;      ///< of RepairParams, at most
};

/// Those of a15(), z_phase(), acute_slab() and acute_cube(), made once; null for another tiling.
///
/// Prices are measured (star_costs) but for Z, where a site's are those of A15 with as many neighbours: 12 and 14
/// neighbours are the Frank-Kasper polyhedra of A15 in Z too. Z's third kind, 15 neighbours, is priced like 14.
const LabelPrices* label_prices(const Tiling& tiling);

/// That of a15().
const LabelEnergies& a15_label_energies();

}  // namespace umtet
