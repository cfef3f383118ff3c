#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/lattice_part.h"
#include "distributed/partition.h"
#include "mesh/base/id_set.h"
#include "mesh/classification/classification.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// make_manifold() of what all ranks have together. There is hardly ever anything to mend, and what is mended first may
/// decide what comes next: so rank 0 does it, and reads the blocks around bad vertices from those that have them.
///
/// Collective. @param bad  own outside vertices where the boundary is no manifold
/// @param inside  of known vertices; receives the changes
/// @param n_psi_evaluations  on rank 0 theirs are added
/// @return what is otherwise than it was, by ids of the whole, ascending; the same on all ranks
std::vector<ManifoldFlip> make_parts_manifold(MPI_Comm comm, const LatticePart& part, const Partition& partition,
                                              ImplicitFunctionRef psi, const ClassificationParams& params,
                                              const std::vector<std::int64_t>& bad, IdSet& inside,
                                              std::size_t& n_psi_evaluations);

}  // namespace umtet
