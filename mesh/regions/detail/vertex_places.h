#pragma once

#include <cstddef>
#include <vector>

#include "common/vec3.h"
#include "mesh/core/boundary_strata.h"
#include "mesh/regions/region_domain.h"

namespace umtet::detail {

/// The patches of the sheets between these regions, ascending.
std::vector<int> patches_between(const RegionDomain& domain, RegionSet regions);

/// The point near x where all patches are 0, in the least-squares sense, or x.
/// @param h  edge length: a step is at most h, and the point is within 2 h of x
Vec3 common_zero(const RegionDomain& domain, const std::vector<int>& patches, const Vec3& x, double h);

/// The stratum of vertices at these regions: a sheet for two of them, a curve for three, a corner for more. The place
/// of a corner is not set.
Stratum stratum_of(const RegionDomain& domain, RegionSet regions);

/// Where vertices are once they lie on the stratum of the regions around them. The place of a vertex for a set of
/// regions is found once.
class VertexPlaces {
 public:
  /// @param domain  must outlive this
  VertexPlaces(const RegionDomain& domain, std::size_t n_vertices) : domain_(domain), known_(n_vertices) {}

  /// The foot of x on the stratum of `regions`, or x: where regions has one member, and where there is no foot.
  Vec3 at(std::size_t vertex, RegionSet regions, const Vec3& x, double h);

 private:
  struct Place {
    RegionSet regions;
    Vec3 place;
  };
  const RegionDomain& domain_;
  std::vector<std::vector<Place>> known_;  ///< per vertex
};

}  // namespace umtet::detail
