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
  std::vector<Message> notices;  ///< notices to the user about changes and guesses
};

/// Properties of samples of triangles: they have no noise, and their spacing varies with the thickness of the body.
struct ExactSamples {
  double least_spacing = 0;  ///< least spacing of the samples, model units, > 0
};

/// Measures the noise unless FitOptions::noise gives it, fits psi, and checks that psi bounds a body.
/// @param cloud  samples in model coordinates. Their normals are turned over where psi requires it (turned_fit.h);
///               coordinates are the same after the call.
/// @param near   neighbour distances of the points, with their covering; empty: they are computed
/// @param bands  computes the bands of the fit; null: this process computes them
/// @param exact  set for samples of triangles; empty for samples of a scanner
/// \throw SolveTooLarge  the fit would need more memory than is allowed
/// \throw SolveError     the solve fails, psi bounds no body, or the samples fill a volume
/// \throw Cancelled
/// Reports "noise" and the steps of fit_ssd().
LevelSetFit fit_level_set(OrientedPointCloud& cloud, NeighbourDistances near, const BodyOptions& options,
                          const Context& context, BandRefiner* bands = nullptr,
                          const std::optional<ExactSamples>& exact = std::nullopt);

}  // namespace umtet
