#pragma once

#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// Returns the stage that causes a certificate to fail, the number that shows it, and a remedy with its flag. The first
/// of these causes that applies is chosen: missing parts of the input, normals, noise, --max-tets, h, psi, the mesh
/// itself. A stage comes before the stages that work on its result, because later stages cannot repair it.
/// \pre !certificate.verdict.passes()
Blame blame_for(const Certificate& certificate);

}  // namespace umtet
