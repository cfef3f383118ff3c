#pragma once

#include <mpi.h>

#include <optional>

#include "distributed/mesh/distributed_mesh.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Distributed version of certify(), with positive faces: every number and list is bit-identical for any number of
/// ranks. Like certify(), it does not rely on the algorithm that made the mesh. Collective; the result is the same on
/// all ranks.
/// @param h                    see CertificateInput::h
/// @param psi                  thread-safe; given on all ranks or on none
/// @param coordinate_rounding  CertificateInput::coordinate_rounding
/// \throw std::invalid_argument on all ranks if no rank has a tet
MeshCertificate certify_parts(MPI_Comm comm, const DistributedMesh& mesh, double h,
                              std::optional<ImplicitFunctionRef> psi, double coordinate_rounding = 0);

}  // namespace umtet
