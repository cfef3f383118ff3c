#pragma once

#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/backtracking_projection.h"
#include "mesh/fast/fast_mesh.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

struct WarmStart {
  std::vector<unsigned char> recalled;  ///< per vertex of the layer: it began at its place in the last mesh
  std::size_t n_recalled = 0;
  bool is_on_surface = false;  ///< all Boundary vertices are: none is left to project
  std::size_t psi_evaluations = 0;
};

/// Where the layer of a domain that has moved begins: on psi = 0 at once, with the rest drawn along.
///
/// A vertex that is inside or outside as in `memory`, with all its neighbours, is recalled: it begins at its place
/// there. Boundary vertices then go to their closest points, and recalled inner ones move as the vertices around them
/// do in the mean, one sweep of it. Inner ones that are not recalled are displaced from the background by u, with u_i
/// the mean of u over the other vertices of the tets at i, from three sweeps over these equations. Where that leaves a
/// tet below projection.least_quality, its vertices go back to the background, and project() takes them from there.
///
/// @param layer   at the places of the background; receives those to begin with. The same for any number of threads
/// @param inside  the inside vertices of this mesh
/// \throw Cancelled
WarmStart warm_start(const BackgroundMesh& background, ImplicitFunctionRef psi, const IdSet& inside,
                     const FastMemory& memory, const ProjectionParams& projection, BackgroundLayer& layer,
                     const Context& context = {});

}  // namespace umtet
