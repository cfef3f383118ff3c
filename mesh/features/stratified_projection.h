#pragma once

#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"

namespace umtet {

/// Parameters of project_onto_strata().
struct StratifiedProjectionParams {
  /// A vertex advances while every tet of its ring stays at this mean ratio, or at the worst of the ring; in (0, 1).
  double least_quality = .2;
  int passes = 3;       ///< rounds in which the vertices go the whole way, in equal parts; >= 1
  int max_rounds = 40;  ///< >= passes
  int sweeps = 4;       ///< sweeps of smoothing after each round; >= 0
  SmoothingParams smoothing = {};
};

/// Results of project_onto_strata().
struct StratifiedProjectionReport {
  int rounds = 0;
  std::vector<int> not_arrived;  ///< vertices of the layer, ascending
};

/// Moves the Boundary vertices of a layer onto their strata without inverting a tet.
///
/// Corners go to their places, vertices of a curve to given points of it, all others to the foot on their patch. A
/// vertex goes a part of the way if a tet holds it back. Between rounds the others are smoothed, with those that have
/// arrived on their strata. Those that have not arrived in the end are put there all at once, or one by one; this
/// counts if smoothing untangles every tet. \pre layer.strata is set
/// @param target  per vertex of the layer: the point to go to, or not finite for the foot on the stratum
/// \throw Cancelled
StratifiedProjectionReport project_onto_strata(PNormSmoother& smoother, ImplicitFunctionRef psi,
                                               const std::vector<Vec3>& target,
                                               const StratifiedProjectionParams& params, const Context& context = {});

}  // namespace umtet
