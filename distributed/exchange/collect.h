#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/mpi_count.h"

// Gather and broadcast of short lists of rare objects to and from rank 0, and reductions over all ranks.
namespace umtet {

/// Returns the rank of this process in a communicator.
inline int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// Returns the sum of a count over all ranks. Collective.
inline std::size_t sum(MPI_Comm comm, std::size_t n) {
  std::uint64_t all = n;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
  return all;
}

/// Gathers lists on rank 0, in the order of ranks; the result is empty on other ranks. Collective. T must not contain
/// pointers.
/// \throw std::length_error  above 2^31 - 1 members in total on rank 0, or in the list of a rank
template <class T>
std::vector<T> gathered(MPI_Comm comm, const std::vector<T>& own) {
  constexpr const char* kTooMany = "a list of more than 2^31 - 1 members";
  int n_ranks = 1, n = mpi_count(own.size(), kTooMany);
  MPI_Comm_size(comm, &n_ranks);
  std::vector<int> counts(static_cast<std::size_t>(n_ranks), 0), begins;
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  std::size_t all = 0;
  for (const int c : counts) {
    begins.push_back(static_cast<int>(all));
    all += static_cast<std::size_t>(c);
    mpi_count(all, kTooMany);
  }
  std::vector<T> result(all);
  MPI_Datatype type;
  MPI_Type_contiguous(static_cast<int>(sizeof(T)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Gatherv(own.data(), n, type, result.data(), counts.data(), begins.data(), type, 0, comm);
  MPI_Type_free(&type);
  return result;
}

/// Broadcasts a list of any length from rank 0 to the others. Collective. T must not contain pointers.
/// @param own  the list of rank 0; ignored on other ranks
template <class T>
void broadcast(MPI_Comm comm, const std::vector<T>& own, std::vector<T>& list) {
  constexpr std::size_t kAtOnce = 1 << 30;  // MPI counts by int
  std::uint64_t n = own.size();
  MPI_Bcast(&n, 1, MPI_UINT64_T, 0, comm);
  if (rank_in(comm) != 0) list.resize(n);
  const auto* from = reinterpret_cast<const std::byte*>(rank_in(comm) == 0 ? own.data() : list.data());
  for (std::size_t at = 0, all = n * sizeof(T); at < all; at += kAtOnce)
    MPI_Bcast(const_cast<std::byte*>(from + at), static_cast<int>(std::min(kAtOnce, all - at)), MPI_BYTE, 0, comm);
}

/// Broadcasts a list from rank 0 in place.
template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& list) {
  broadcast(comm, list, list);
}

}  // namespace umtet
