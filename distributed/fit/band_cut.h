#pragma once

#include <vector>

#include "reconstruct/basis/lattice_blocks.h"
#include "reconstruct/solve/ssd_sample.h"

// Partition of the blocks of a band: each rank solves consecutive blocks.
namespace umtet {

/// Returns the index of the first block of each rank, followed by the total number of blocks. All ranks get about equal
/// work, and therefore need about equal memory.
/// @param samples  samples of the band, in block order
/// @param held     bytes per sample that rank 0 holds for other purposes; its share of the blocks is smaller by this
///                 amount (first_share())
std::vector<int> cut_band(const LatticeBlocks& blocks, const std::vector<SsdSample>& samples, int n_ranks,
                          double held = 0);

/// Returns the rank that solves a block.
/// @param begin  result of cut_band()
int rank_of_block(const std::vector<int>& begin, int block);

/// Returns the blocks begin .. end - 1 and their neighbours, in ascending order.
std::vector<int> with_neighbours(const LatticeBlocks& blocks, int begin, int end);

/// Returns for each rank the runs of samples (block_runs()) that it needs, in ascending order. A rank needs a run if a
/// basis function of one of its blocks is nonzero at the samples of the run.
std::vector<std::vector<std::size_t>> runs_of_ranks(const LatticeBlocks& blocks, const std::vector<int>& begin,
                                                    const std::vector<SsdSample>& samples,
                                                    const std::vector<std::size_t>& runs);

}  // namespace umtet
