#pragma once

#include <mpi.h>

#include <functional>
#include <optional>

#include "body/body.h"
#include "distributed/program/held_mesh.h"
#include "pipeline/case/parameters.h"

namespace umtet {

/// Main loop of the ranks other than 0: executes the commands of rank 0 (Ranks) until it sends the end. Collective.
/// @param parameters  called before the first work
/// @param domain      makes the domain of a psi that is not fitted to samples; null: load_domain()
/// @param taken       receives the local mesh of this rank when Ranks::release() is called
/// @return the exit code of the program
int serve(MPI_Comm comm, const std::function<Parameters()>& parameters, const std::function<Domain()>& domain = {},
          std::optional<TakenMesh>* taken = nullptr);

}  // namespace umtet
