#pragma once

#include <limits>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/implicit/zero_set.h"
#include "mesh/octree/bcc_link.h"
#include "mesh/sizes/graded_size.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// The longest edge on which graded_zero_set() looks at psi, of its share of the size there: the width of a leaf.
inline const double kLongestCountedEdge = kSizeTolerance * kMostAboveLeast / kBccMeanEdge;

/// Topology of {psi = 0} in a box, counted on a graded mesh of its own: edges at psi = 0 are up to kLongestCountedEdge
/// `share` times the size there. See zero_set_topology() for what that proves: here what is thinner than an edge of its
/// place may be missed, and the cost is that of the surface in edges, whatever the least of them.
///
/// @param share     of the sizes, > 0
/// @param finest    the least size, model units
/// @param steepest  a bound of |grad psi|: cubes that are farther from psi = 0 are left out
/// \throw std::invalid_argument  as GradedMesh; Cancelled
ZeroSetTopology graded_zero_set(ImplicitFunctionRef psi, const Box& box, const SizeField& sizes, double share,
                                double finest, double steepest = std::numeric_limits<double>::infinity(),
                                const Context& context = {});

}  // namespace umtet
