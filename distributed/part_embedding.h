#pragma once

#include <mpi.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "distributed/lattice_part.h"
#include "distributed/neighbourhood.h"
#include "distributed/partition.h"
#include "mesh/base/id_set.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A rank's part of a mesh that may meet itself.
struct PartSurface {
  const TetMesh& mesh;                                       ///< own tets and all their vertices, in their places
  const std::vector<std::int64_t>& vertex;                   ///< of each vertex, by ids of LatticePart
  const IdSet& inside;                                       ///< of known vertices
  const std::vector<std::pair<std::int64_t, Vec3>>& places;  ///< of own vertices off the background, ascending
};

/// step_back() of what all ranks have together. Whether two faces of the boundary meet or a tet is not positive each
/// rank finds of its own, with the faces of its neighbours near by. That is hardly ever so; where it is, rank 0 reads
/// the blocks around and lets vertices step back, as one process does.
///
/// Collective. @return the vertices that have stepped back and where they are, by ids of the whole, ascending; the same
/// on all ranks
std::vector<std::pair<std::int64_t, Vec3>> step_parts_back(MPI_Comm comm, const LatticePart& part,
                                                           const Partition& partition, Neighbourhood& ranks,
                                                           const PartSurface& surface);

}  // namespace umtet
