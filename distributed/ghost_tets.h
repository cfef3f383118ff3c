#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "distributed/solver_part.h"

namespace umtet {

/// A tet of another rank that has a vertex with own ones in common. Numbers are those of the whole mesh.
struct GhostTet {
  std::int64_t tet;
  std::int64_t corner[4];
  double place[4][3];
  int rank;  ///< whose it is
};

/// Those next to the own tets, by numbers. Collective.
std::vector<GhostTet> ghost_tets(MPI_Comm comm, const DistributedMesh& mesh, const SolverPart& part);

}  // namespace umtet
