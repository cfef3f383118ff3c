#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/context.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

/// Report of step_back().
struct StepBackReport {
  std::size_t n_pairs = 0, n_inverted = 0;  ///< before: pairs of faces that meet, tets that are not positive
  int rounds = 0;
  std::vector<int> vertices;  ///< the vertices that were moved, ascending
};

/// Makes a mesh of omega_h embedded: moves vertices back until every tet is positive, by exact sign, and no two faces
/// of the boundary intersect (self_intersections.h).
///
/// Sheets of the boundary that are closer to each other than the sagitta of their faces may pierce each other. The
/// vertices of such faces step .05 h (the h of the vertex) inwards along their normals, round by round, while every tet
/// of their rings stays at Q >= .2, or at least as good as the ring's worst tet. Where that does not help, and where a
/// tet is not positive, vertices move a quarter of their way back to the background position in each round.
///
/// In the background mesh all tets are positive and no faces meet. In each round that finds a defect, some vertex that
/// is off its background position moves closer to it, so the loop ends. If there is no defect, nothing changes, and
/// only the two tests are paid for.
/// @param walls  boundary faces whose vertices do not move
/// @param h      edge length of the background at a vertex, model units
/// @param V      the positions, numbered as submesh.mesh.V; receives the new ones
/// \throw Cancelled
StepBackReport step_back(const Submesh& submesh, const std::vector<Triangle>& walls,
                         const std::function<double(int v)>& h, std::vector<Vec3>& V, const Context& context = {});

}  // namespace umtet
