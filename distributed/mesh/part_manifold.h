#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/partition/lattice_part.h"
#include "distributed/partition/partition.h"
#include "mesh/base/id_set.h"
#include "mesh/classification/classification.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Distributed version of make_manifold(). Repairs are rare, and each may affect the next. Rank 0 therefore makes them,
/// and reads the blocks around bad vertices from the ranks that have them.
///
/// Collective.
/// @param bad     own outside vertices at which the boundary is not a manifold
/// @param inside  inside vertices among the known vertices; receives the changes
/// @param n_psi_evaluations  counter that is increased on rank 0 by the number of evaluations
/// @return all changes, with ids of the whole lattice, ascending; the same on all ranks
std::vector<ManifoldFlip> make_parts_manifold(MPI_Comm comm, const LatticePart& part, const Partition& partition,
                                              ImplicitFunctionRef psi, const ClassificationParams& params,
                                              const std::vector<std::int64_t>& bad, IdSet& inside,
                                              std::size_t& n_psi_evaluations);

}  // namespace umtet
