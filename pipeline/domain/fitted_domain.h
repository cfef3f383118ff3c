#pragma once

#include "pipeline/domain/domain.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {

/// psi with the samples that it was fitted to; no triangles.
/// @param psi    near the origin, as the report's shift says
/// @param cloud  model coordinates; may be empty
Domain fitted_domain(LevelSet psi, OrientedPointCloud cloud, const LevelSetReport& report);

}  // namespace umtet
