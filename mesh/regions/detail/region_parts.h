#pragma once

#include <vector>

#include "mesh/regions/region_domain.h"
#include "mesh/regions/region_mesh.h"

namespace umtet::detail {

/// The members of a set, ascending.
std::vector<int> members(RegionSet set);

/// Sets regions_at from the tets and their regions.
void find_regions_at_vertices(RegionMesh& made);

/// Lists the interfaces and the defects of a mesh that is otherwise finished, and removes the tets of region 0 if the
/// mesh has no outside.
/// @param made  with regions_at
/// @return per vertex that was in the mesh: its new number, or -1
std::vector<int> finish(const RegionDomain& domain, bool has_outside, RegionMesh& made);

}  // namespace umtet::detail
