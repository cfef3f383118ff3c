#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/p_norm_smoothing.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// docs/constants.md has what other values do.
struct ProjectionParams {
  int passes = 3;       ///< N_P: parts of the way, with smoothing of inner vertices after each; >= 1
  int max_rounds = 20;  ///< attempts in all, those of passes included; >= passes
  /// Mean ratio: a step leaves every tet of the star at this or more, or not worse than its worst; in (0, 1)
  double least_quality = .2;
  int sweeps = 3;             ///< sweeps of smoothing after each round; >= 0
  SmoothingParams smoothing;  ///< max_sweeps is not used, sweeps is
  ClosestPointParams closest_point;
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const ProjectionParams&);

struct NotArrived {
  enum class Reason {
    NoFoot,  ///< the closest point was not found from where it is
    Guard    ///< the last attempt would have left a tet below least_quality and worse than it was
  };
  int vertex;
  Reason reason;
};

struct ProjectionReport {
  std::size_t boundary = 0;             ///< Boundary vertices
  std::vector<NotArrived> not_arrived;  ///< ascending vertex; empty when all is well
  int rounds = 0;
  std::size_t stopped_short = 0;    ///< vertices the guard held back at least once
  std::size_t psi_evaluations = 0;  ///< those of the smoothing included
  double min_quality = 1;           ///< the worst tet with a vertex that is not Fixed; by project(layer) only
  SmoothingReport smoothing;        ///< what it says of the layer, too
};

/// Moves the Boundary vertices of a layer to their closest points on psi = 0.     [Rangarajan2018, Alg. 1, 23-30]
///
/// In pass k of N_P each vertex is offered k / N_P of its way, colour by colour, and takes as much of the step (all of
/// it, a half, a quarter, an eighth) as leaves every tet of its ring at Q >= least_quality, or not worse than its
/// worst. Inner vertices are smoothed after each pass but the last. If some were held back, those that have arrived
/// slide on the surface and make room, and the others try again; in every third round these relax like inner vertices
/// first. Their feet are found anew from where they are. A layer without a tet at Q <= 0 gets none.
///
/// Vertices that arrive satisfy |psi| / |grad psi| <= 1e-10 h (closest_point.tol). The same bytes for any number of
/// threads. The smoother must be of the layer as it is; afterwards it can go on with its queue and its rings.
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
ProjectionReport project(PNormSmoother& smoother, ImplicitFunctionRef psi, const ProjectionParams& params = {},
                         const Context& context = {});
ProjectionReport project(ActiveLayer& layer, ImplicitFunctionRef psi, const ProjectionParams& params = {},
                         const Context& context = {});

}  // namespace umtet
