#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/context.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

struct StepBackReport {
  std::size_t n_pairs = 0, n_inverted = 0;  ///< faces that met, tets that were not positive, before
  int rounds = 0;
  std::vector<int> vertices;  ///< that have been moved, ascending
};

/// Makes a mesh of omega_h embedded: vertices go back until every tet is positive, by exact sign, and no two faces of
/// the boundary meet (self_intersections.h).
///
/// Sheets of the boundary nearer to each other than the sagitta of their faces may pierce each other. The vertices of
/// such faces step .05 h (their own) inwards, along their normals, round by round, as long as no tet of their rings
/// falls below Q = .2 or what it had. Where that does not help, and where a tet is not positive, they go a quarter of
/// their way back to where the background mesh has them, each round. In the background mesh all tets are positive and
/// no faces meet: so in each round that finds something, a vertex that is not there yet goes nearer to it, and this
/// ends. Nothing is changed, and the cost is that of the two tests, where nothing is wrong.
/// @param walls  boundary faces that no vertex of moves
/// @param h      edge length of the background at a vertex, model units
/// @param V      receives the places, numbered as submesh.mesh.V
/// \throw Cancelled
StepBackReport step_back(const Submesh& submesh, const std::vector<Triangle>& walls,
                         const std::function<double(int v)>& h, std::vector<Vec3>& V, const Context& context = {});

}  // namespace umtet
