#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/mesh/distributed_mesh.h"
#include "distributed/mesh/vertex_owners.h"
#include "distributed/second_order/part_edges.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/second_order/second_order_certificate.h"

// Distributed ten-node tets. All functions are collective.
namespace umtet {

/// The local part of a ten-node mesh.
struct CurvedParts {
  QuadraticTetMesh mesh;  ///< local tets: the vertices of the linear mesh, and the mid-sides of PartEdges::number()
  std::vector<char> is_curved;  ///< per mid-side: whether its edge belongs to a positive face on any rank
  std::size_t n_off_surface = 0, n_unprojected = 0, n_slid = 0, n_relaxed = 0;  ///< as in SecondOrder, on all ranks
};

/// Distributed version of quadratic_tets(), with the same result to the bit. Mid-sides are projected onto psi = 0 on
/// each rank that has them. They are relaxed on rank 0, one after the other as in one process: rank 0 receives the tets
/// that need relaxation and those around them.
CurvedParts curved_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartEdges& edges, ImplicitFunctionRef psi,
                         double h, const SecondOrderParams& params = {});

/// Distributed version of certify_second_order(); the result is the same on all ranks.
SecondOrderCertificate certify_curved_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                            const PartEdges& edges, const CurvedParts& curved, ImplicitFunctionRef psi,
                                            double h, double coordinate_rounding);

}  // namespace umtet
