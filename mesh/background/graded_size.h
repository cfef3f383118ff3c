#pragma once

#include <limits>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/size_field.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// About how many tets of a GradedMesh of these sizes are taken for {psi < 0}: 12 a leaf whose centre is inside, before
/// the octree is balanced, and a share for balance and for the layer by which omega_h exceeds the domain.
/// @param finest    mean edge length of the smallest tets, model units
/// @param steepest  a bound of |grad psi|: cubes that are farther from psi = 0 are left out
/// Cost: one query of sizes and one value of psi a cube. Threads over cubes; the result does not depend on them.
/// \throw std::invalid_argument for an empty box or finest <= 0; Cancelled
double expected_graded_tets(const SizeField& sizes, double finest, ImplicitFunctionRef psi, const Box& box,
                            double steepest = std::numeric_limits<double>::infinity(), const Context& context = {});

}  // namespace umtet
