#pragma once

#include <mpi.h>

#include <optional>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Broadcasts the level set of rank 0, bit-identical, to all ranks. Collective.
/// @param own  level set of rank 0; ignored on other ranks
/// @return the level set on all ranks; on rank 0 it shares the coefficients of `own`
LevelSet shared_level_set(MPI_Comm comm, const std::optional<LevelSet>& own);

}  // namespace umtet
