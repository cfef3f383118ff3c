#pragma once

#include "mesh/universal_mesh.h"
#include "pipeline/case/parameters.h"
#include "reconstruct/solve/fit_ssd.h"

namespace umtet {

/// What the section `reconstruct` of the parameters says to the library. \throw UsageError with every broken constraint
SsdParams ssd_params(const Parameters&);

/// What the section `mesh` of the parameters says to the library. \throw UsageError with every broken constraint
UmParams um_params(const Parameters&);

}  // namespace umtet
