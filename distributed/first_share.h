#pragma once

#include <algorithm>

// Rank 0 runs the program and holds what nobody else does. So that no rank needs more memory than the others, it has
// less of what all share.
namespace umtet {

/// What of all shared work rank 0 is to have: where that takes `bytes` on all ranks together, all hold the same with
/// it. Not less than a quarter of an equal share, because the others wait for each other, too.
/// @param held  bytes that rank 0 holds besides
inline double first_share(int n_ranks, double held, double bytes) {
  constexpr double kLeast = .25;
  const double n = n_ranks;
  if (n_ranks == 1 || !(bytes > 0)) return 1 / n;
  // held + share bytes = (1 - share) bytes / (n - 1)
  return std::max(kLeast, 1 - (n - 1) * held / bytes) / n;
}

/// What of it the ranks before this one have: ranks after the first have equal shares.
inline double share_before(int rank, int n_ranks, double first) {
  return rank == 0 ? 0 : rank >= n_ranks ? 1 : first + (1 - first) * (rank - 1) / (n_ranks - 1);
}

}  // namespace umtet
