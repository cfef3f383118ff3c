#pragma once

#include <mpi.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "distributed/exchange/neighbourhood.h"
#include "distributed/partition/lattice_part.h"
#include "distributed/partition/partition.h"
#include "mesh/base/id_set.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The local mesh of a mesh that may intersect itself.
struct PartSurface {
  const TetMesh& mesh;                                       ///< local tets and all their vertices, at their positions
  const std::vector<std::int64_t>& vertex;                   ///< id of each vertex in LatticePart
  const IdSet& inside;                                       ///< inside vertices among the known vertices
  const std::vector<std::pair<std::int64_t, Vec3>>& places;  ///< own vertices off the background, ascending
};

/// Distributed version of step_back(). Each rank tests whether two boundary faces intersect or a tet is not positive,
/// for its own faces and tets and the nearby faces of its neighbours. This is rare; if it occurs, rank 0 reads the
/// blocks around and moves vertices back, as one process does.
///
/// Collective.
/// @return the vertices that were moved back, with ids of the whole lattice and positions, ascending; the same on all
///         ranks
std::vector<std::pair<std::int64_t, Vec3>> step_parts_back(MPI_Comm comm, const LatticePart& part,
                                                           const Partition& partition, Neighbourhood& ranks,
                                                           const PartSurface& surface);

}  // namespace umtet
