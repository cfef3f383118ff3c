#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/part_boundary.h"
#include "mesh/embedding/self_intersections.h"

namespace umtet {

/// How many self_intersections() the boundary of all ranks has. Space is divided into cubes; faces in a cube that
/// several ranks have go to the first of these, and a pair is counted in one cube that it is in. Collective.
/// @param edge  of a cube: a few edges of the mesh
std::size_t meetings_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary, double edge);

/// How many pieces are wrongly_nested(). Collective. \pre a closed manifold that does not meet itself
/// @param volumes  of the pieces
std::size_t wrongly_nested_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary,
                                    const BoundaryTopology& topology, const std::vector<EnclosedVolume>& volumes);

}  // namespace umtet
