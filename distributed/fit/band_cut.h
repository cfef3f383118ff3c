#pragma once

#include <vector>

#include "reconstruct/basis/lattice_blocks.h"
#include "reconstruct/solve/ssd_sample.h"

// Which rank solves which blocks of a band: consecutive ones, in their order.
namespace umtet {

/// Where the blocks of each rank begin, and how many there are: pieces of about equal work, which is also their memory.
/// @param samples  of the band, in block order
/// @param held     bytes that rank 0 holds besides for each of them: its piece is so much smaller (first_share())
std::vector<int> cut_band(const LatticeBlocks& blocks, const std::vector<SsdSample>& samples, int n_ranks,
                          double held = 0);

/// The rank that has a block. @param begin  by cut_band()
int rank_of_block(const std::vector<int>& begin, int block);

/// The blocks begin .. end - 1 and those next to them, ascending.
std::vector<int> with_neighbours(const LatticeBlocks& blocks, int begin, int end);

/// Runs of samples (block_runs) whose functions belong to a block of each rank, ascending.
std::vector<std::vector<std::size_t>> runs_of_ranks(const LatticeBlocks& blocks, const std::vector<int>& begin,
                                                    const std::vector<SsdSample>& samples,
                                                    const std::vector<std::size_t>& runs);

}  // namespace umtet
