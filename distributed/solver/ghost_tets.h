#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/solver/solver_part.h"

namespace umtet {

/// A ghost tet: a tet of another rank that shares a vertex with local tets. Numbers are those of the whole mesh.
struct GhostTet {
  std::int64_t tet;
  std::int64_t corner[4];
  double place[4][3];
  int rank;  ///< rank of the tet
};

/// Returns the ghost tets of a local mesh, ascending by number. Collective.
std::vector<GhostTet> ghost_tets(MPI_Comm comm, const DistributedMesh& mesh, const SolverPart& part);

}  // namespace umtet
