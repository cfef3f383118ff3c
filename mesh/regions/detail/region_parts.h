#pragma once

#include <cstdint>
#include <functional>
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
/// @param position  of a vertex of the background, model units
/// @param made      with regions_at and labels
/// @return per vertex that was in the mesh: its new number, or -1
std::vector<int> finish(const RegionDomain& domain, const RegionMeshParams& params,
                        const std::function<Vec3(std::int64_t)>& position, RegionMesh& made);

}  // namespace umtet::detail
