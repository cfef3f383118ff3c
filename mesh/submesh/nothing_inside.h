#pragma once

#include <string>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Status and evidence of a domain without an inside vertex.
struct NothingInside {
  UmStatus status;  ///< EmptyDomain, or PsiNotFinite if psi is finite at no vertex of the background
  UmEvidence evidence;
};

/// Finds the reason why no background vertex is inside. A vertex where psi is not finite counts as outside, and the
/// first such vertex is the evidence.
/// @param search  further text about the search
/// Cost: one more evaluation of psi at every vertex of the background. \throw Cancelled
NothingInside nothing_inside(const BackgroundMesh& background, ImplicitFunctionRef psi, const Context& context,
                             const std::string& search = {});

}  // namespace umtet
