#pragma once

#include "common/context.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/flips/local_flips.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// flip_locally() on a fitted mesh, whose tets are then no longer a set of tets of the background.
///
/// The result keeps in UmResult::of_background what it was before. Vertices keep their order and background ids,
/// without those that were collapsed; tets that are the background's come first, ascending, and new ones have
/// background_tet -1. Vertices on walls, and boundary vertices that are not on psi = 0, stay where they are.
/// @param h       edge length: a vertex within 1e-6 h of psi = 0 is on it
/// @param result  status Success; else nothing happens
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
LocalFlipReport flip_submesh(ImplicitFunctionRef psi, double h, const LocalFlipParams& params, UmResult& result,
                             const Context& context = {});

}  // namespace umtet
