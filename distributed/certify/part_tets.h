#pragma once

#include <mpi.h>

#include "distributed/mesh/distributed_mesh.h"
#include "mesh/certify/certificate.h"

namespace umtet {

/// Computes n_tets, volume, quality and h of the certificate of the whole mesh, with the same result as one process:
/// sums are over the same tets in the same order, and quantiles are selected by counting. Collective; the result is the
/// same on all ranks.
/// @param h  if positive, certificate.h gets this value
/// \pre there is a tet on some rank
void measure_tets_of_parts(MPI_Comm comm, const DistributedMesh& mesh, double h, MeshCertificate& certificate);

}  // namespace umtet
