#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/owner_exchange.h"
#include "distributed/part_edges.h"
#include "distributed/part_second_order.h"
#include "distributed/sharers.h"
#include "distributed/solver_part.h"
#include "distributed/vertex_owners.h"
#include "mesh/core/quadratic_tet_mesh.h"

// Nodes of second order as solvers number and divide them: the vertices of the own mesh, and behind them its mid-sides
// in the order of CurvedParts. All functions are collective.
namespace umtet {

/// What a SolverPart says of vertices and faces, of nodes and faces of second order. Tets and patches are those of
/// that.
struct CurvedSolverPart {
  std::size_t n_nodes = 0;                  ///< of all ranks
  std::vector<std::int64_t> global_node;    ///< in the mesh of one process: mid-sides come behind all vertices
  std::vector<int> owner;                   ///< the least rank that has a tet with the node
  std::vector<std::int64_t> solver_node;    ///< as SolverPart::solver_vertex
  Sharers sharers;                          ///< of nodes
  std::vector<QuadraticTriangle> boundary;  ///< by face of SolverPart::boundary
  std::vector<int> boundary_nodes;          ///< own ones on it, ascending, also those without an own face there
};

CurvedSolverPart curved_solver_part(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                    const PartEdges& edges, const CurvedParts& curved, const SolverPart& part);

/// Nodes between those who have tets with them and the one rank that owns each: its vertices in the order of
/// VertexOwners::ids(), then its mid-sides in that of PartEdges::owned().
OwnerExchange node_exchange(const VertexOwners& owners, const PartEdges& edges);

}  // namespace umtet
