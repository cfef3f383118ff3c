#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/owner_exchange.h"

// Who else has what a rank has, and how solvers number it. The items are vertices, or nodes of second order. All
// functions but first_ranks() are collective.
namespace umtet {

/// Items of a rank that other ranks have tets with, too.
struct Sharers {
  std::vector<int> vertex;         ///< of the own mesh, ascending
  std::vector<std::size_t> begin;  ///< of each in `rank`, and at last the end
  std::vector<int> rank;           ///< of each vertex ascending, without this one
};

Sharers sharers_of(MPI_Comm comm, const OwnerExchange& items);

/// Of each item the least rank that has a tet with it.
std::vector<int> first_ranks(MPI_Comm comm, std::size_t n_items, const Sharers& sharers);

/// Of each item its number where each rank counts those that it is the first of, one rank after the other; in the
/// order of items.
std::vector<std::int64_t> numbers_by_rank(MPI_Comm comm, const std::vector<int>& first_rank,
                                          const OwnerExchange& items);

}  // namespace umtet
