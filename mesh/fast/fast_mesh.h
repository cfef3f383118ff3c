#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/former_mesh.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// A boundary-fitting mesh of {psi < 0}, better and some ten times faster than Algorithm 1.
///
/// classification: which background vertices near psi = 0 count as inside is chosen for the shape of the tets
/// (classification.h), where that has costs (configuration_costs.h); layer: only the boundary of omega_h and two layers
/// behind it move (linked_active_layer.h); projection: boundary vertices walk to psi = 0 as far as no tet of
/// their rings falls below Q = .2 or what it had (backtracking_projection.h); smoothing: p-norm Newton steps where a
/// tet is below the target (p_norm_smoothing.h); tangential relaxation: boundary vertices slide on to ridges that h
/// does not resolve (tangential_relaxation.h); repair: vertices change between inside and outside where a tet is still
/// below the target (repair.h).
///
/// It always ends in a mesh, unless psi has no inside in the background or reaches its boundary: the boundary of
/// omega_h is a manifold by the choice of its tets (manifold_boundary.h), no tet is let invert on the way, and where
/// the boundary meets itself in the end, vertices go back (step_back.h). Vertices may then be off psi = 0, which a
/// certificate says.
///
/// The result is that of universal_mesh(): omega_h of the chosen inside vertices, with the background's ids. The same
/// bytes for any number of threads. psi must be thread-safe. Reports the steps "project", "relax" and "repair". \pre
/// params are those universal_mesh() accepts
/// @param chosen  by classified_submesh(): what failed there is the result
/// \throw Cancelled
UmResult fast_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                   const FastParams& params, ChosenSubmesh chosen, const Context& context = {});

/// The step before: which vertices count as inside, and how many tets that makes, at a quarter of what listing them
/// costs. Repair may change both by a few. Reports the steps "search" and "submesh".
/// @param seeds  as those of universal_mesh(). \throw Cancelled
ChosenSubmesh classified_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const SubmeshParams& submesh, const FastParams& params, const Context& context = {},
                                 const std::vector<Vec3>& seeds = {});

/// The same where a mesh in a background that differs at some places only has been made: what is not near these stays
/// as it is, its classification and its places. \pre no walls; psi and params are those of that mesh. \throw Cancelled
ChosenSubmesh classified_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const SubmeshParams& submesh, const FastParams& params, const FormerMesh& former,
                                 const Context& context = {});

/// What the mesh of one psi leaves to that of the next, in the same background mesh.
struct FastMemory {
  IdSet negative{0};                                 ///< psi < 0
  IdSet inside{0};                                   ///< as classified
  std::vector<std::pair<std::int64_t, Vec3>> moved;  ///< vertices off their background places, ascending
  std::size_t n_recalled = 0;                        ///< of these, how many the last mesh began with
  std::shared_ptr<const VertexLinks> links;          ///< of the background
};

/// The same from known inside vertices, those with psi < 0. The classification stays as
/// in `memory` if psi has the signs it had everywhere, else where another costs little less
/// (ClassificationParams::keep), and the layer begins near its places there (warm_start.h). There is no tangential
/// relaxation.
/// @param memory  empty (no `moved`) at first; receives that of this mesh, or becomes empty if there is none
/// @param known   of this psi, its values at the vertices where the search for `inside` evaluated it
UmResult fast_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                   const FastParams& params, const Context& context, IdSet inside, FastMemory& memory,
                   const PsiValues& known = {});

}  // namespace umtet
