#pragma once

#include <vector>

#include "mesh/label_quality.h"
#include "mesh/link_topology.h"
#include "mesh/tiling.h"

namespace umtet {

/// What the choice of labels needs to know of a tiling.
struct LabelPrices {
  std::vector<LinkTopology> links;
  LabelEnergies energies;
};

/// Those of a15() and z_phase(), made once; null for a tiling whose labels have no prices.
///
/// Prices of A15 are measured (labels_fit). A site's prices are those of its coordination number: 12 and 14 neighbours
/// are the Frank-Kasper polyhedra of A15 in Z too. Z's third kind, 15 neighbours, is priced like 14.
const LabelPrices* label_prices(const Tiling& tiling);

}  // namespace umtet
