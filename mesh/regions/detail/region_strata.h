#pragma once

#include <vector>

#include "mesh/core/boundary_strata.h"
#include "mesh/regions/region_domain.h"
#include "mesh/regions/region_mesh.h"

namespace umtet::detail {

/// The strata of a region mesh: a sheet for two regions at a vertex, a curve for three, a corner for four or more.
struct RegionStrata {
  /// Finds the strata of the vertices from made.regions_at, made.mesh.V and made.h.
  RegionStrata(const RegionDomain& domain, const RegionMesh& made);

  /// The points that the vertices go to: corners to their place, vertices of curves to points that are spread along the
  /// curve; not finite for the foot on the stratum.
  /// @param made  as in the constructor, with tets
  std::vector<Vec3> targets(const RegionMesh& made) const;

  std::vector<int> of_vertex;  ///< -1: inside of a region
  BoundaryStrata strata;
};

}  // namespace umtet::detail
