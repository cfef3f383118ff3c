#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/certify/part_boundary.h"
#include "distributed/mesh/distributed_mesh.h"
#include "mesh/embedding/self_intersections.h"

namespace umtet {

/// Returns the number of self_intersections() of the boundary of the whole mesh. Space is divided into cubes. Faces in
/// a cube that several ranks share are sent to the first of these, and a pair is counted in one of its cubes.
/// Collective.
/// @param edge  edge length of a cube: a few edges of the mesh
std::size_t meetings_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary, double edge);

/// Returns the number of components that are wrongly_nested(). Collective.
/// \pre the boundary is a closed manifold without self-intersections
/// @param volumes  volumes of the components
std::size_t wrongly_nested_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary,
                                    const BoundaryTopology& topology, const std::vector<ComponentVolume>& volumes);

}  // namespace umtet
