#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/owner_exchange.h"
#include "distributed/exchange/sharers.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/mesh/vertex_owners.h"
#include "distributed/second_order/part_edges.h"
#include "distributed/second_order/part_second_order.h"
#include "distributed/solver/solver_part.h"
#include "mesh/core/quadratic_tet_mesh.h"

// Ten-node tets with the numbering and partition that solvers use. Nodes are the vertices of the local mesh, followed
// by its mid-sides in the order of CurvedParts. All functions are collective.
namespace umtet {

/// The data of a SolverPart on vertices and faces, for nodes and six-node faces. Tets and patches are those of the
/// SolverPart.
struct CurvedSolverPart {
  std::size_t n_nodes = 0;                  ///< number of nodes of the whole mesh
  std::vector<std::int64_t> global_node;    ///< numbers in the mesh of one process, where mid-sides follow all vertices
  std::vector<int> owner;                   ///< least rank with a tet at the node
  std::vector<std::int64_t> solver_node;    ///< numbers of nodes like SolverPart::solver_vertex
  Sharers sharers;                          ///< ranks that share each node
  std::vector<QuadraticTriangle> boundary;  ///< six-node faces in the order of SolverPart::boundary
  std::vector<int> boundary_nodes;  ///< local nodes on the boundary, ascending, also those without a local face there
};

/// Computes the numbering of nodes and six-node faces.
CurvedSolverPart curved_solver_part(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                    const PartEdges& edges, const CurvedParts& curved, const SolverPart& part);

/// Exchange of node data between ranks with tets at a node and the one rank that owns it. The owned nodes are the
/// vertices in the order of VertexOwners::ids(), followed by the mid-sides in the order of PartEdges::owned().
OwnerExchange node_exchange(const VertexOwners& owners, const PartEdges& edges);

}  // namespace umtet
