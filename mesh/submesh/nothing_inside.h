#pragma once

#include <string>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

struct NothingInside {
  UmStatus status;  ///< EmptyDomain, or PsiNotFinite where no vertex of the background has a number
  UmEvidence evidence;
};

/// Why no background vertex was found inside: what is not finite counts as outside, and its first place is the
/// evidence.
/// @param search  what else to say about the search
/// Cost: psi at every vertex of the background, once more. \throw Cancelled
NothingInside nothing_inside(const BackgroundMesh& background, ImplicitFunctionRef psi, const Context& context,
                             const std::string& search = {});

}  // namespace umtet
