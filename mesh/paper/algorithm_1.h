#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/paper/relaxation_direction.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Parameters of algorithm_1().
struct PaperParams {
  int projection_passes = 5;       ///< N_P: positive vertices reach the boundary in this many steps, eq. (1); >= 1
  int relaxation_iterations = 25;  ///< N_R of Algorithms 1 and 2; >= 0
  int samples = 20;                ///< N_S: 2 N_S + 1 candidates in [-h, h], eq. (7); >= 1
  DirectionRule directions = DirectionRule::Random;  ///< Section 3.8(d); least_quality in mesh_bench compares
  /// Exact; in a build without GSL GoldenSection, the paper's faster, suboptimal choice (Fig. 18).
  MaxMin max_min = kBestMaxMin;
  ClosestPointParams closest_point;
  std::uint64_t seed = 0;      ///< random tangents of boundary dvr are a function of (seed, iteration, vertex)
  bool keep_iterates = false;  ///< stores UmResult::iterates
};

/// All broken constraints, not just the first; empty if the parameters are valid.
std::vector<std::string> problems(const PaperParams&);

/// Algorithm 1 of the paper to the letter, steps 23-35: projection and relaxation of omega_h   [Rangarajan2018]
///
/// A double positive face or an obtuse conditioning angle becomes the status only if a projection diverges or a tet
/// inverts at it. Reports the steps "project" and "relax". psi must be thread-safe.
/// \pre universal_mesh() accepts the params
/// @param chosen  result of submesh_by_sign(); a failure there is passed on as the result
/// \throw Cancelled
UmResult algorithm_1(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                     const PaperParams& params, ChosenSubmesh chosen, const Context& context = {});

}  // namespace umtet
