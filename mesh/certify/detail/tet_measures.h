#pragma once

#include <cstddef>

#include "common/context.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/tet_mesh.h"

namespace umtet::detail {

/// Computes n_tets, n_vertices, volume, quality and h of a certificate. Uses threads over tets; the result does not
/// depend on them. Working memory: a byte per vertex, and the qualities of a few per cent of the tets.
/// @param h       certificate.h if > 0
/// @param memory  if not null, supplies known values of tets, and receives new ones
/// \pre at least one tet, all indices in range
/// \throw Cancelled
void measure_tets(const TetMesh& mesh, double h, const Context& context, CertificateMemory* memory,
                  MeshCertificate& certificate);

}  // namespace umtet::detail
