#pragma once

#include <mpi.h>

#include <optional>

#include "distributed/distributed_mesh.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// certify() of the mesh that all ranks have together, with its positive faces: the same in every number and list, to
/// the bit, for any number of ranks. The mesh is not trusted more than there. Collective; the same on all ranks.
/// @param h                    CertificateInput::h, of the same meaning
/// @param psi                  thread-safe; of all ranks or of none
/// @param coordinate_rounding  CertificateInput::coordinate_rounding
/// \throw std::invalid_argument on all ranks where none has a tet
MeshCertificate certify_parts(MPI_Comm comm, const DistributedMesh& mesh, double h,
                              std::optional<ImplicitFunctionRef> psi, double coordinate_rounding = 0);

}  // namespace umtet
