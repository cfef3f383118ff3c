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

/// What classification and repair need to know of a tiling.
struct ConfigurationCosts {
  std::vector<LinkTopology> links;
  double good;  ///< of StarCostTable
  StarCostTable costs;
  double repair_target;  ///< mean ratio that nearly every tet has before repair, which works on those below
  int repair_reach;      ///< of RepairParams, at most
};

/// Those of a15(), z_phase(), acute_slab() and acute_cube(), made once; null for another tiling.
///
/// Costs are measured (tools/star_costs) but for Z, whose sites have those of the sites of A15 with as many neighbours:
/// links of 12 and of 14 neighbours are the same Frank-Kasper polyhedra in both. Z's third kind of site, with 15
/// neighbours, has the costs of 14.
const ConfigurationCosts* configuration_costs(const Tiling& tiling);

/// What they need to know of a background mesh.
struct BackgroundCosts {
  std::shared_ptr<const VertexLinks> links;
  StarCostTable costs;
  double repair_target;
  int repair_reach;
};

/// Of a lattice the configuration_costs() of its tiling; of any other mesh its links, and costs by how many faces and
/// tets share the angles at a vertex. None for a tiling without costs, and for a mesh with a vertex that has more than
/// kMaxLink neighbours.
/// @param links  what an earlier call for this background gave, or null
std::optional<BackgroundCosts> background_costs(const BackgroundMesh& background,
                                                std::shared_ptr<const VertexLinks> links = nullptr);

/// That of a15().
const StarCostTable& a15_star_costs();

}  // namespace umtet
