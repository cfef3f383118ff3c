#pragma once

#include <optional>

#include "body/body.h"
#include "body/scan/scan_reports.h"

namespace umtet {

/// Returns a domain that consists of psi and the samples to which it was fitted, without triangles.
/// @param psi    level set near the origin; report.shift moves it to model coordinates
/// @param cloud  samples, model coordinates; may be empty
/// @param box    box that the background mesh must cover, model coordinates; empty: the box of psi
Domain fitted_domain(LevelSet psi, OrientedPointCloud cloud, const LevelSetReport& report,
                     const std::optional<Box>& box);

}  // namespace umtet
