#pragma once

#include <mpi.h>

#include <functional>
#include <optional>

#include "distributed/program/held_mesh.h"
#include "pipeline/case/parameters.h"
#include "body/body.h"

namespace umtet {

/// Of the ranks other than 0, which has Ranks: does what it says, until it says the end. Collective. @return the exit
/// code
/// @param parameters  is called before the first work
/// @param domain  of a psi that is not fitted to samples; null: load_domain()
/// @param taken  what this rank has of what Ranks::release() gives away
int serve(MPI_Comm comm, const std::function<Parameters()>& parameters, const std::function<Domain()>& domain = {},
          std::optional<TakenMesh>* taken = nullptr);

}  // namespace umtet
