#pragma once

#include <cstddef>

#include "common/context.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/tet_mesh.h"

namespace umtet::detail {

/// Fills n_tets, n_vertices, volume, quality and h of a certificate. Threads over tets; the result does not depend on
/// them. Holds a byte a vertex, and the qualities of some hundredths of the tets.
/// @param h       certificate.h if > 0
/// @param memory  if not null, of what is known of the tets, and receives that
/// \pre at least one tet, all indices in range   \throw Cancelled
void measure_tets(const TetMesh& mesh, double h, const Context& context, CertificateMemory* memory,
                  MeshCertificate& certificate);

}  // namespace umtet::detail
