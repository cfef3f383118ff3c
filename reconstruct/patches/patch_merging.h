#pragma once

#include <vector>

#include "reconstruct/patches/patch_cloud.h"

namespace umtet {

/// Merges patches whose sheets turn by less than 25 degrees on average along their border, unless a stretch of six
/// sites turns by more than 30 degrees. The smoothest borders come first, and patches with a sharp border between them
/// stay apart.
/// @param labels  renumbered: patches from 0 in the order of their first samples
/// @return true if any were merged
/// Cost: O(border samples). The result does not depend on the number of threads.
bool merge_smooth_borders(const PatchCloud& cloud, std::vector<int>& labels);

}  // namespace umtet
