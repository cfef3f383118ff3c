#pragma once

#include <vector>

#include "common/context.h"
#include "mesh/regions/region_domain.h"
#include "mesh/regions/region_mesh.h"

namespace umtet::detail {

/// Moves interface vertices onto their strata, and smooths the layers around them: step 3 of make_region_mesh().
/// @param is_fixed  per vertex: stays where it is, as on the boundary of the mesh
/// @param made      with tets, regions, h and regions_at
void move_onto_strata(const RegionDomain& domain, const std::vector<char>& is_fixed, const RegionMeshParams& params,
                      RegionMesh& made, const Context& context);

/// Raises the worst tets of all regions by local flips: step 4 of make_region_mesh(). Vertices that no tet has any more
/// leave the mesh; regions_at is not renewed.
void flip_regions(const RegionDomain& domain, const std::vector<char>& is_fixed, const LocalFlipParams& params,
                  RegionMesh& made, const Context& context);

}  // namespace umtet::detail
