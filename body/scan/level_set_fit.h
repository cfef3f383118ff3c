#pragma once

#include <optional>
#include <vector>

#include "body/options.h"
#include "body/scan/scan_reports.h"
#include "common/context.h"
#include "common/message.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

struct LevelSetFit {
  LevelSet psi;
  LevelSetReport report;
  std::vector<Message> notices;  ///< what was changed or guessed, for the user
};

/// What is known of samples of triangles: they have no noise, and their spacing goes with the thickness of the body.
struct ExactSamples {
  double least_spacing = 0;  ///< model units, > 0
};

/// The noise, unless FitOptions::noise gives it, psi, and whether it bounds a body.
/// @param cloud  model coordinates, which it has again afterwards; normals that psi opposes are turned over
/// (turned_fit.h)
/// @param near   of its points, with their covering; empty: searched here
/// @param bands  makes the bands of the fit; null: this process does
/// @param exact  of a cloud of triangles; none: of a scanner
/// \throw SolveTooLarge  psi would not fit in the memory that is allowed
/// \throw SolveError     no psi, or one that bounds no body, or samples that fill a volume
/// \throw Cancelled
/// Reports "noise" and the steps of fit_ssd().
LevelSetFit fit_level_set(OrientedPointCloud& cloud, NeighbourDistances near, const BodyOptions& options,
                          const Context& context, BandRefiner* bands = nullptr,
                          const std::optional<ExactSamples>& exact = std::nullopt);

}  // namespace umtet
