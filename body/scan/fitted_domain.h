#pragma once

#include <optional>

#include "body/body.h"
#include "body/scan/scan_reports.h"

namespace umtet {

/// psi with the samples that it was fitted to; no triangles.
/// @param psi    near the origin, as the report's shift says
/// @param cloud  model coordinates; may be empty
/// @param box    what the background mesh has to cover, model coordinates; none: that of psi
Domain fitted_domain(LevelSet psi, OrientedPointCloud cloud, const LevelSetReport& report,
                     const std::optional<Box>& box);

}  // namespace umtet
