#pragma once

#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

/// Result of crawl().
struct Crawl {
  Submesh submesh;
  std::vector<std::size_t> lost_seeds;  ///< indices of the seeds from which no positively cut tet was found
  std::size_t n_psi_evaluations = 0;
};

/// Finds omega_h without a loop over the background mesh                           [Rangarajan2018, Section 3.8(c)]
///
/// 1. From each seed, a local search follows psi to a positively cut tet.
/// 2. From there the positive faces are collected, each from its neighbours across edges.
/// 3. The interior is flooded from the inside vertices of the positively cut tets. The flood does not evaluate psi:
///    every tet at an inside vertex is in omega_h, and a vertex that step 2 did not meet is inside.
///
/// @param seeds  at least one point within a few h of every component of the boundary, cavities included
/// @return equal to find_submesh() bit for bit if every component has its seed and every outside vertex next to an
///         inside one is positive. The second condition fails only where Omega's complement is thinner than an edge.
/// Cost: about ten values of psi per positive vertex; memory: a few bits per background vertex and tet. The search and
/// the flood are serial; the tets are then listed by all threads, in a few nanoseconds per cell of the background.
/// \throw Cancelled
Crawl crawl(const BackgroundMesh& background, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds,
            const Context& context = {});

}  // namespace umtet
