#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/sharers.h"
#include "distributed/vertex_owners.h"

namespace umtet {

/// A part of a mesh of all ranks as solvers number and divide it.
struct SolverPart {
  std::size_t n_vertices = 0, n_tets = 0, n_faces = 0;  ///< of all ranks; of faces those on the boundary
  std::vector<std::int64_t> global_vertex, global_tet;  ///< of own ones, their numbers in the mesh of one process
  /// Of each vertex the least rank that has a tet with it. Other than the owner of a DistributedMesh it has the vertex.
  std::vector<int> owner;
  /// Of each vertex its number where each rank counts what it owns, one rank after the other; in the order of vertices.
  std::vector<std::int64_t> solver_vertex;
  Sharers sharers;
  std::vector<Triangle> boundary;         ///< faces of own tets on the boundary of the whole mesh, outward
  std::vector<std::int64_t> global_face;  ///< of each of these, its number among those of all ranks
  std::vector<int> patch;                 ///< of each of these faces; index into patches
  std::vector<int> boundary_vertices;     ///< own ones on it, ascending, also those without an own face there
  std::vector<std::string>
      patches;  ///< names, of all ranks: `boundary`, or `boundary_1` ... by area as in `umtet export`
};

/// Collective.
SolverPart solver_part(MPI_Comm comm, const DistributedMesh& mesh);
SolverPart solver_part(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners);

}  // namespace umtet
