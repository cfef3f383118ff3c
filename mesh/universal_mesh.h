#pragma once

#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/update/former_mesh.h"
#include "mesh/paper/algorithm_1.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Method of universal_mesh().
enum class UmMode {
  /// Extends the paper: chosen inside vertices, backtracking projection, p-norm smoothing of a layer, repair; see
  /// fast_mesh.h
  Fast,
  Paper,  ///< Algorithm 1 to the letter; see algorithm_1.h
};

/// Parameters of universal_mesh().
struct UmParams {
  UmMode mode = UmMode::Fast;
  SubmeshParams submesh = {};
  FastParams fast = {};    ///< parameters of UmMode::Fast
  PaperParams paper = {};  ///< parameters of UmMode::Paper
};

/// All broken constraints, not just the first; empty if the parameters are valid.
std::vector<std::string> problems(const UmParams&);

/// Boundary-fitting mesh of {psi < 0}, by Algorithm 1 of the paper or by its extension in fast_mesh.h.
///
/// Foreseen failures are statuses with evidence; the arrays of the result then hold the last iterate.
/// - UmMode::Fast makes a mesh whenever psi has an inside that h can resolve and that stays off the background
///   boundary.
/// - In UmMode::Paper a double positive face or an obtuse conditioning angle breaks an assumption of the algorithm, but
///   need not break the mesh. Both are counted in the result. They become the status only if a projection diverges or a
///   tet inverts at that face or angle. With double positive faces the boundary of the mesh is not the set of positive
///   faces, and the certificate reports this.
/// - To mesh the outside of a body in a box, pass a Complement (implicit_function.h) as psi and make the background
///   boundary a wall. Walls are flat in an a15_box().
///
/// @param seeds  for SubmeshSearch::Crawl: at least one point near every component of the boundary
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
UmResult universal_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params = {},
                        const Context& context = {}, const std::vector<Vec3>& seeds = {});

/// First step of universal_mesh(): chooses the tets of the background that become the mesh. Reports the steps "search"
/// and "submesh".
/// @param seeds  as for universal_mesh()
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
ChosenSubmesh choose_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params = {},
                             const Context& context = {}, const std::vector<Vec3>& seeds = {});

/// Chooses the tets where a mesh already exists in another background that differs from this one only locally, such as
/// an octree before refinement. Away from the differences the mesh stays the same to the bit.
/// @param former  made with the same components of psi and the same params, in UmMode::Fast without walls
/// \throw std::invalid_argument naming every broken constraint of params, or for UmMode::Paper; Cancelled
ChosenSubmesh choose_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                             const FormerMesh& former, const Context& context = {});

/// Second step of universal_mesh(): moves vertices until the boundary is on psi = 0 and the tets are well shaped.
/// Reports the steps "project", "relax" and, in UmMode::Fast, "repair".
/// @param chosen  result of choose_submesh() for the same background, psi and params; a failure there is passed on as
///                the result
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
UmResult fit_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                     ChosenSubmesh chosen, const Context& context = {});

}  // namespace umtet
