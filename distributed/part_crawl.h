#pragma once

#include <mpi.h>

#include <vector>

#include "distributed/lattice_part.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Of the vertices of lattice() that are known, those that crawl_inside() finds in the whole lattice. Rank 0 crawls, as
/// one process does: along psi = 0, and through what is behind it by bits. They are told to the others a megabyte at a
/// time. Collective.
/// @param seeds  read on rank 0
IdSet crawl_part(MPI_Comm comm, const LatticePart& part, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds);

}  // namespace umtet
