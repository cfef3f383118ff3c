#pragma once

#include <vector>

#include "reconstruct/patches/patch_cloud.h"

namespace umtet {

/// Moves samples near borders to the patch that they fit best: iterated conditional modes [Besag1986] of
///
///     sum_i (distance of sample i from the sheet of its patch / noise)^2 + (angle between normals / tilt)^2
///       + sum over neighbours of different patches of a constant                                  (Potts)
///
/// The sheet of a patch near sample i is fitted to the neighbours of i on this patch, without i.
/// @return the number of samples that changed
/// Cost: O(border samples). The result does not depend on the number of threads.
std::size_t reassign_at_borders(const PatchCloud& cloud, std::vector<int>& labels);

}  // namespace umtet
