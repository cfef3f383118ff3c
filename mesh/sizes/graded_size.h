#pragma once

#include <limits>
#include <numbers>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// Leaves of a graded mesh are split while their mean edge length exceeds this times cube_size(): edges are from
/// 1 / sqrt(2) to sqrt(2) of the size where it varies slowly.
inline constexpr double kSizeTolerance = std::numbers::sqrt2;

/// Sizes fall over a cube by up to .87 grade times its width; a source in a corner has edges at most this much longer
/// than it asks for, times kSizeTolerance.
inline constexpr double kMostAboveLeast = 1.2;

/// The size of a cube: that in its middle, but at most kMostAboveLeast times the least in it.
double cube_size(const SizeField& sizes, const Vec3& centre, double half_width);

/// About how many tets of a GradedMesh of these sizes are taken for {psi < 0}: 12 a leaf whose centre is inside, before
/// the octree is balanced, and a share for balance and for the layer by which omega_h exceeds the domain.
/// @param finest    mean edge length of the smallest tets, model units
/// @param steepest  a bound of |grad psi|: cubes that are farther from psi = 0 are left out
/// Cost: one query of sizes and one value of psi a cube. Threads over cubes; the result does not depend on them.
/// \throw std::invalid_argument for an empty box or finest <= 0; Cancelled
double expected_graded_tets(const SizeField& sizes, double finest, ImplicitFunctionRef psi, const Box& box,
                            double steepest = std::numeric_limits<double>::infinity(), const Context& context = {});

}  // namespace umtet
