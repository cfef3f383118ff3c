#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/owner_exchange.h"

// Ranks that share the items of a rank, and the numbering for solvers. The items are vertices, or nodes of ten-node
// tets. All functions but first_ranks() are collective.
namespace umtet {

/// Local items at which other ranks also have tets.
struct Sharers {
  std::vector<int> vertex;         ///< shared local vertices, ascending
  std::vector<std::size_t> begin;  ///< begin of each vertex's ranks in `rank`, and the end of the last
  std::vector<int> rank;           ///< ranks of each vertex, ascending, without this one
};

/// Finds the sharers of all local items.
Sharers sharers_of(MPI_Comm comm, const OwnerExchange& items);

/// Returns for each item the least rank with a tet at it.
std::vector<int> first_ranks(MPI_Comm comm, std::size_t n_items, const Sharers& sharers);

/// Returns for each item its number in this numbering: each rank numbers in order the items whose first rank it is, and
/// its numbers follow those of lower ranks.
std::vector<std::int64_t> numbers_by_rank(MPI_Comm comm, const std::vector<int>& first_rank,
                                          const OwnerExchange& items);

}  // namespace umtet
