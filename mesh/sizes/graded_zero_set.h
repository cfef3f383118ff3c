#pragma once

#include <limits>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/implicit/zero_set.h"
#include "mesh/octree/bcc_link.h"
#include "mesh/sizes/graded_size.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// The longest edge on which graded_zero_set() evaluates psi, relative to share * size: the width of a leaf.
inline const double kLongestCountedEdge = kSizeTolerance * kMostAboveLeast / kBccMeanEdge;

/// Topology of {psi = 0} in a box, counted on a separate graded mesh, whose edges at psi = 0 are up to
/// kLongestCountedEdge * `share` times the local size. zero_set_topology() explains what such a count proves. Here a
/// feature thinner than the local edge may be missed, and the cost is proportional to the surface measured in edges,
/// whatever the least edge.
///
/// @param share     fraction of the sizes, > 0
/// @param finest    the least size, model units
/// @param steepest  an upper bound of |grad psi|: cubes farther from psi = 0 are skipped
/// \throw std::invalid_argument under the conditions of GradedMesh; Cancelled
ZeroSetTopology graded_zero_set(ImplicitFunctionRef psi, const Box& box, const SizeField& sizes, double share,
                                double finest, double steepest = std::numeric_limits<double>::infinity(),
                                const Context& context = {});

}  // namespace umtet
