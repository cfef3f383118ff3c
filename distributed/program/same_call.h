#pragma once

#include <mpi.h>

#include <string>

#include "pipeline/case/json_values.h"

namespace umtet {

/// Checks that all ranks were called for the same mesh. Collective.
/// @param mine  names and values of the parameters of this rank
/// @return the first difference from rank 0, as a sentence, the same on all ranks; empty if there is none
std::string difference_of_calls(MPI_Comm comm, const Json& mine);

}  // namespace umtet
