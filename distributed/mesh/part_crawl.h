#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/partition/lattice_part.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Distributed version of crawl_inside(): its inside vertices in the whole lattice, restricted to the known vertices of
/// lattice(). Rank 0 crawls like a single process: along psi = 0, and through the interior with one bit per vertex. It
/// sends the result to the others a megabyte at a time. Collective.
/// @param seeds  read on rank 0
/// @param n_psi_evaluations  counter that is increased on rank 0 by the number of evaluations
IdSet crawl_part(MPI_Comm comm, const LatticePart& part, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds,
                 std::size_t& n_psi_evaluations);

}  // namespace umtet
