#pragma once

#include <vector>

#include "reconstruct/patches/edge_evidence.h"
#include "reconstruct/patches/sample_patches.h"

namespace umtet {

/// Decides which borders are sharp edges, and merges patches that have none between them.
///
/// A border is sharp if at least half of its sites are accepted (accepted_sites()). Patches merge across other borders,
/// unless they touch only at a corner, the weakest borders first; but not if they had a sharp border before. This
/// repeats until nothing changes. Without any sharp border all samples are one patch.
/// @param labels  patches from 0 in the order of their first samples; renumbered
/// @return the borders between the patches that are left, with lengths in sample spacings
std::vector<SamplePatches::Border> accept_edges(const PatchCloud& cloud, std::vector<int>& labels,
                                                const EdgeThresholds& enough);

}  // namespace umtet
