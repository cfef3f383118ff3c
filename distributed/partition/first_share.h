#pragma once

#include <algorithm>

// Rank 0 runs the program and holds data that no other rank has. So that no rank needs more memory than the others, its
// share of the common work is smaller.
namespace umtet {

/// Returns the fraction of shared work for rank 0. If the work takes `bytes` on all ranks together, all ranks then hold
/// the same number of bytes. The fraction is at least a quarter of an equal share, because ranks also wait for each
/// other.
/// @param held  bytes of other data on rank 0
inline double first_share(int n_ranks, double held, double bytes) {
  constexpr double kLeast = .25;
  const double n = n_ranks;
  if (n_ranks == 1 || !(bytes > 0)) return 1 / n;
  // held + share bytes = (1 - share) bytes / (n - 1)
  return std::max(kLeast, 1 - (n - 1) * held / bytes) / n;
}

/// Returns the total fraction of the ranks before this one; all ranks except the first have equal shares.
inline double share_before(int rank, int n_ranks, double first) {
  return rank == 0 ? 0 : rank >= n_ranks ? 1 : first + (1 - first) * (rank - 1) / (n_ranks - 1);
}

}  // namespace umtet
