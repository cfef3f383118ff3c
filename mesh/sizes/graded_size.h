#pragma once

#include <limits>
#include <numbers>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// Leaves of a graded mesh are split while their mean edge length exceeds this factor times cube_size(). Edges are then
/// 1 / sqrt(2) to sqrt(2) of the size where it varies slowly.
inline constexpr double kSizeTolerance = std::numbers::sqrt2;

/// Bound on cube_size() relative to the least size in the cube. Sizes vary over a cube by up to .87 grade times its
/// width; at a source in a corner, edges exceed the required size by at most this factor times kSizeTolerance.
inline constexpr double kMostAboveLeast = 1.2;

/// The size of a cube: the size at its centre, but at most kMostAboveLeast times the least size in it.
double cube_size(const SizeField& sizes, const Vec3& centre, double half_width);

/// Returns the expected number of tets of a GradedMesh with these sizes in the mesh of {psi < 0}. It counts 12 tets per
/// leaf whose centre is inside, before the octree is balanced, and adds a share for balancing and for the layer by
/// which omega_h exceeds the domain.
/// @param finest    mean edge length of the smallest tets, model units
/// @param steepest  an upper bound of |grad psi|: cubes farther from psi = 0 are skipped
/// Cost: one query of sizes and one value of psi per cube. Uses threads over cubes; the result does not depend on them.
/// \throw std::invalid_argument for an empty box or finest <= 0; Cancelled
double expected_graded_tets(const SizeField& sizes, double finest, ImplicitFunctionRef psi, const Box& box,
                            double steepest = std::numeric_limits<double>::infinity(), const Context& context = {});

}  // namespace umtet
