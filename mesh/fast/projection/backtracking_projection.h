#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// Parameters of project(). docs/constants.md lists the effect of other values.
struct ProjectionParams {
  int passes = 3;  ///< N_P: number of parts of the way to psi = 0, with smoothing of inner vertices after each; >= 1
  int max_rounds = 20;  ///< attempts in all, passes included; >= passes
  /// Mean ratio: a step leaves every tet of the star at or above this value, or at least as good as the star's worst
  /// tet; in (0, 1)
  double least_quality = .2;
  int sweeps = 3;             ///< sweeps of smoothing after each round; >= 0
  SmoothingParams smoothing;  ///< its max_sweeps is not used; `sweeps` takes its place
  ClosestPointParams closest_point;
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const ProjectionParams&);

/// A Boundary vertex that did not reach psi = 0, with the reason.
struct NotArrived {
  enum class Reason {
    NoFoot,  ///< no closest point was found from the vertex's position
    Guard    ///< the last attempt would have left a tet below least_quality and worse than before
  };
  int vertex;
  Reason reason;
};

/// Report of project().
struct ProjectionReport {
  std::size_t boundary = 0;             ///< number of Boundary vertices
  std::vector<NotArrived> not_arrived;  ///< ascending by vertex; empty if all arrived
  int rounds = 0;
  std::size_t stopped_short = 0;    ///< vertices that the guard held back at least once
  std::size_t psi_evaluations = 0;  ///< includes the evaluations of smoothing
  double min_quality = 1;  ///< mean ratio of the worst tet with a vertex that is not Fixed; set by project(layer) only
  SmoothingReport smoothing;  ///< includes the state of the layer that smoothing reports
};

/// Projects the Boundary vertices of a layer onto psi = 0, with backtracking on quality.     [Rangarajan2018, Alg. 1,
/// 23-30]
///
/// In pass k of N_P each vertex is offered k / N_P of its way to its closest point, colour by colour. It takes the
/// longest of four steps (whole, half, quarter, eighth) that leaves every tet of its ring at Q >= least_quality, or at
/// least as good as the ring's worst tet. Inner vertices are smoothed after each pass but the last.
///
/// If some vertices were held back, those that have arrived slide on the surface and make room, and the others try
/// again. In every third round the vertices held back first relax like inner vertices, and their foot points are
/// computed from their new positions. No tet with Q <= 0 is created in a layer without one.
///
/// Vertices that arrive satisfy |psi| / |grad psi| <= 1e-10 h (closest_point.tol). The bytes are the same for any
/// number of threads.
/// @param smoother  smoother of the layer in its present state; its queue and its rings are valid after the call
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
ProjectionReport project(PNormSmoother& smoother, ImplicitFunctionRef psi, const ProjectionParams& params = {},
                         const Context& context = {});
ProjectionReport project(ActiveLayer& layer, ImplicitFunctionRef psi, const ProjectionParams& params = {},
                         const Context& context = {});

}  // namespace umtet
