#pragma once

#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/update/fast_memory.h"
#include "mesh/fast/update/former_mesh.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Boundary-fitting mesh of {psi < 0}, of higher quality than Algorithm 1 and about ten times faster.
///
/// 1. Classification: the background vertices near psi = 0 that count as inside are chosen for the shape of the tets
///    (classification.h), if the background has costs (configuration_costs.h).
/// 2. Layer: only the boundary of omega_h and two layers behind it move (linked_active_layer.h).
/// 3. Projection: boundary vertices move towards psi = 0 while every tet of their rings stays at Q >= .2, or at least
///    as good as the ring's worst tet (backtracking_projection.h).
/// 4. Smoothing: p-norm Newton steps where a tet is below the target (p_norm_smoothing.h).
/// 5. Tangential relaxation: boundary vertices slide onto ridges that h does not resolve (tangential_relaxation.h).
/// 6. Repair: vertices change between inside and outside where a tet is still below the target (repair.h).
///
/// The result is always a mesh, unless psi has no inside in the background or reaches the background boundary: the
/// choice of tets makes the boundary of omega_h a manifold (manifold_boundary.h), no tet may invert on the way, and
/// where the final boundary meets itself, vertices go back (step_back.h). Such vertices may be off psi = 0, and the
/// certificate reports this.
///
/// The result has the form of universal_mesh(): omega_h of the chosen inside vertices, with the ids of the background.
/// The bytes are the same for any number of threads. psi must be thread-safe. Reports the steps "project", "relax" and
/// "repair".
/// \pre universal_mesh() accepts the params
/// @param chosen  result of classified_submesh(); a failure there is passed on as the result
/// \throw Cancelled
UmResult fast_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                   const FastParams& params, ChosenSubmesh chosen, const Context& context = {});

/// The step before fast_mesh(): chooses the vertices that count as inside and counts the tets of omega_h, at a quarter
/// of the cost of listing them. Repair may change both slightly. Reports the steps "search" and "submesh".
/// @param seeds  as in universal_mesh()
/// \throw Cancelled
ChosenSubmesh classified_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const SubmeshParams& submesh, const FastParams& params, const Context& context = {},
                                 const std::vector<Vec3>& seeds = {});

/// Chooses the inside vertices where a mesh already exists in a background that differs only locally. Away from the
/// differences, classification and positions stay unchanged.
/// \pre no walls; psi and params are the same as for that mesh
/// \throw Cancelled
ChosenSubmesh classified_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const SubmeshParams& submesh, const FastParams& params, const FormerMesh& former,
                                 const Context& context = {});

/// Boundary-fitting mesh from known inside vertices, those with psi < 0, warm-started from the last mesh. There is no
/// tangential relaxation.
///
/// If psi has the same sign as before at every vertex, the classification stays as in `memory`; otherwise it stays
/// where another costs little less (ClassificationParams::keep). The layer begins near its positions in the last mesh
/// (warm_start.h).
/// @param memory  empty (no `moved`) at first; receives the state of this mesh, or becomes empty if no mesh was made
/// @param known   values of this psi at the vertices where the search for `inside` evaluated it
UmResult fast_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& submesh,
                   const FastParams& params, const Context& context, IdSet inside, FastMemory& memory,
                   const PsiValues& known = {});

}  // namespace umtet
