#pragma once

#include <mpi.h>

#include "distributed/distributed_mesh.h"
#include "mesh/certify/certificate.h"

namespace umtet {

/// Fills n_tets, volume, quality and h of the certificate of what all ranks have together, as one process does: sums
/// are those of the same tets in the same order, and quantiles are selected by counting. Collective; the same on all
/// ranks.
/// @param h  certificate.h if > 0   \pre a tet, on some rank
void measure_tets_of_parts(MPI_Comm comm, const DistributedMesh& mesh, double h, MeshCertificate& certificate);

}  // namespace umtet
