#pragma once

#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// The stage to blame for a certificate that fails, the number that says so, and a remedy with its flag. The first of
/// these that applies: parts that were not given, normals, noise, --max-tets, h, psi, the mesh itself. A stage comes
/// before those that work on its result, because no later stage can mend it.
/// \pre !certificate.verdict.passes()
Blame blame_for(const Certificate& certificate);

}  // namespace umtet
