#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/part_edges.h"
#include "distributed/vertex_owners.h"
#include "mesh/certify/quadratic_tets.h"
#include "mesh/certify/second_order_certificate.h"

// Tets of second order of all ranks. All functions are collective.
namespace umtet {

/// What a rank has of them.
struct CurvedParts {
  QuadraticTetMesh mesh;  ///< of own tets: the vertices of the linear mesh, and the mid-sides of PartEdges::number()
  std::vector<char> is_curved;  ///< of each mid-side: of an edge of a positive face, of whichever rank
  std::size_t n_off_surface = 0, n_unprojected = 0, n_slid = 0, n_relaxed = 0;  ///< as in SecondOrder, of all ranks
};

/// The mesh that quadratic_tets() makes of the whole one, to the bit. Mid-sides go to psi = 0 on each rank that has
/// them. They are relaxed on rank 0, one after the other as in one process: it is sent the tets that ask for it and
/// those around them.
CurvedParts curved_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartEdges& edges, ImplicitFunctionRef psi,
                         double h, const SecondOrderParams& params = {});

/// What certify_second_order() says of the whole one; on all ranks.
SecondOrderCertificate certify_curved_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                            const PartEdges& edges, const CurvedParts& curved, ImplicitFunctionRef psi,
                                            double h, double coordinate_rounding);

}  // namespace umtet
