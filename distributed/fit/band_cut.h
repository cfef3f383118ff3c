#pragma once

#include <vector>

#include "reconstruct/basis/lattice_blocks.h"
#include "reconstruct/solve/ssd_sample.h"

// Partition of the blocks of a band: each rank solves consecutive blocks.
namespace umtet {

/// The first block of each rank, and the number of blocks at the end. The pieces have about equal work, and therefore
/// memory.
/// @param samples  of the band, in block order
/// @param held     bytes of other data on rank 0 per sample, by which its piece is reduced (first_share())
std::vector<int> cut_band(const LatticeBlocks& blocks, const std::vector<SsdSample>& samples, int n_ranks,
                          double held = 0);

/// The rank of a block. @param begin  result of cut_band()
int rank_of_block(const std::vector<int>& begin, int block);

/// The blocks begin .. end - 1 and their neighbours, ascending.
std::vector<int> with_neighbours(const LatticeBlocks& blocks, int begin, int end);

/// For each rank, the runs of samples (block_runs()) with a function in one of its blocks, ascending.
std::vector<std::vector<std::size_t>> runs_of_ranks(const LatticeBlocks& blocks, const std::vector<int>& begin,
                                                    const std::vector<SsdSample>& samples,
                                                    const std::vector<std::size_t>& runs);

}  // namespace umtet
