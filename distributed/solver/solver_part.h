#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "distributed/exchange/sharers.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/mesh/vertex_owners.h"

namespace umtet {

/// A local mesh with the numbering and partition that solvers use.
struct SolverPart {
  std::size_t n_vertices = 0, n_tets = 0, n_faces = 0;  ///< numbers in the whole mesh; n_faces counts boundary faces
  std::vector<std::int64_t> global_vertex, global_tet;  ///< numbers of vertices and tets in the mesh of one process
  /// Per vertex, the least rank with a tet at it. Unlike the owner in a DistributedMesh, this rank has a local tet with
  /// the vertex.
  std::vector<int> owner;
  /// Number of each vertex if each rank numbers its owned vertices in order, following the numbers of lower ranks.
  std::vector<std::int64_t> solver_vertex;
  Sharers sharers;
  std::vector<Triangle> boundary;         ///< boundary faces of the whole mesh with a local tet, outward
  std::vector<std::int64_t> global_face;  ///< number of each boundary face on all ranks
  std::vector<int> patch;                 ///< index into patches of each boundary face
  std::vector<int> boundary_vertices;     ///< local vertices on the boundary, ascending, with or without a local face
  std::vector<std::string>
      patches;  ///< names on all ranks: `boundary`, or `boundary_1` ... by area as in `umtet export`
};

/// Computes the numbering. Collective.
SolverPart solver_part(MPI_Comm comm, const DistributedMesh& mesh);
SolverPart solver_part(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners);

}  // namespace umtet
