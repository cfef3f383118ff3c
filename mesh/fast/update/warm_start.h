#pragma once

#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/fast/update/fast_memory.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// Report of warm_start().
struct WarmStart {
  std::vector<unsigned char> recalled;  ///< per vertex of the layer: whether it began at its position in the last mesh
  std::size_t n_recalled = 0;
  bool is_on_surface = false;  ///< all Boundary vertices are on psi = 0: none is left to project
  std::size_t psi_evaluations = 0;
};

/// Warm start of the layer of a domain that has moved: boundary vertices begin on psi = 0, and the others are drawn
/// along.
///
/// A vertex is recalled if it and all its neighbours are inside or outside as in `memory`: it begins at its position
/// there. Boundary vertices then move to their closest points. Recalled inner vertices move by the mean displacement of
/// the vertices around them, in one sweep. Inner vertices that are not recalled are displaced from the background by u,
/// with u_i the mean of u over the other vertices of the tets at i, from three sweeps over these equations. Where a tet
/// then falls below projection.least_quality, its vertices go back to the background, and project() moves them from
/// there.
///
/// The result is the same for any number of threads.
/// @param layer   at the positions of the background; receives the initial positions
/// @param inside  the inside vertices of this mesh
/// \throw Cancelled
WarmStart warm_start(const BackgroundMesh& background, ImplicitFunctionRef psi, const IdSet& inside,
                     const FastMemory& memory, const ProjectionParams& projection, BackgroundLayer& layer,
                     const Context& context = {});

}  // namespace umtet
