#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/link_topology.h"
#include "mesh/background/tiling.h"
#include "mesh/background/vertex_links.h"
#include "mesh/classification/star_cost_table.h"

namespace umtet {

/// Data of a tiling for classification and repair.
struct ConfigurationCosts {
  std::vector<LinkTopology> links;
  double good;  ///< see StarCostTable
  StarCostTable costs;
  double repair_target;  ///< mean ratio that nearly every tet reaches before repair, which works on tets below it
  int repair_reach;      ///< upper bound on RepairParams::reach
};

/// Configuration costs of a15(), z_phase(), acute_slab() and acute_cube(), computed once; null for another tiling.
///
/// Costs are measured (tools/star_costs), except for Z. Sites of Z use the costs of A15's sites with the same number of
/// neighbours: the links of 12 and of 14 neighbours are the same Frank-Kasper polyhedra in both. Z's third kind of
/// site, with 15 neighbours, uses the costs for 14.
const ConfigurationCosts* configuration_costs(const Tiling& tiling);

/// Data of a background mesh for classification and repair.
struct BackgroundCosts {
  std::shared_ptr<const VertexLinks> links;
  StarCostTable costs;
  double repair_target;
  int repair_reach;
};

/// For a lattice, the configuration_costs() of its tiling. For any other mesh, its links, and costs by the number of
/// faces and tets that share the angles at a vertex. None for a tiling without costs, and for a mesh with a vertex that
/// has more than kMaxLink neighbours.
/// @param links  result of an earlier call for this background, or null
std::optional<BackgroundCosts> background_costs(const BackgroundMesh& background,
                                                std::shared_ptr<const VertexLinks> links = nullptr);

/// The star cost table of a15().
const StarCostTable& a15_star_costs();

}  // namespace umtet
