#pragma once

#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/former_mesh.h"
#include "mesh/paper/algorithm_1.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

enum class UmMode {
  /// Beyond the paper: chosen inside vertices, backtracking projection and p-norm smoothing of a layer, repair;
  /// fast_mesh.h
  Fast,
  Paper,  ///< Algorithm 1 to the letter; algorithm_1.h
};

struct UmParams {
  UmMode mode = UmMode::Fast;
  SubmeshParams submesh = {};
  FastParams fast = {};    ///< of UmMode::Fast
  PaperParams paper = {};  ///< of UmMode::Paper
};

/// Every broken constraint, not just the first; empty when the parameters are usable.
std::vector<std::string> problems(const UmParams&);

/// A boundary-fitting mesh of {psi < 0}: Algorithm 1 of the paper, or what goes beyond it (fast_mesh.h).
///
/// Foreseen failures are statuses with evidence; the arrays of the result then hold the last iterate. In UmMode::Fast
/// there is a mesh wherever psi has an inside that h can show and that stays off the background boundary. In
/// UmMode::Paper a double positive face or an obtuse conditioning angle breaks an assumption of the algorithm but need
/// not break the mesh: both are counted in the result, and become the status only when a projection diverges or a tet
/// inverts right there. With double positive faces the boundary of the mesh is not the set of positive faces, which a
/// certificate will say.
/// Around a body in a box: psi is a Complement (implicit_function.h), the background boundary a wall; walls are flat in
/// an a15_box().
/// @param seeds  for SubmeshSearch::Crawl: at least one point near every component of the boundary
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
UmResult universal_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params = {},
                        const Context& context = {}, const std::vector<Vec3>& seeds = {});

/// The first of its two steps: which tets of the background become the mesh. Reports "search" and "submesh".
/// @param seeds  as above
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
ChosenSubmesh choose_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params = {},
                             const Context& context = {}, const std::vector<Vec3>& seeds = {});

/// The same where a mesh in another background has been made that differs at some places only, an octree that has been
/// refined there: away from them the mesh stays as it is, to the bit.
/// @param former  of the same pieces of psi and the same params, UmMode::Fast without walls
/// \throw std::invalid_argument naming every broken constraint of params; UmMode::Paper; Cancelled
ChosenSubmesh choose_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                             const FormerMesh& former, const Context& context = {});

/// The second: their vertices move until the boundary is on psi = 0 and the tets are well shaped.
/// Reports "project", "relax" and, in UmMode::Fast, "repair".
/// @param chosen  by choose_submesh() of the same background, psi and params: what failed there is the result
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
UmResult fit_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                     ChosenSubmesh chosen, const Context& context = {});

}  // namespace umtet
