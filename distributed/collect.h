#pragma once

#include <mpi.h>

#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

// Lists that go to rank 0 or come from it: short ones, of what is rare in a mesh.
namespace umtet {

inline int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// What all ranks have, in their order; on rank 0, and nothing elsewhere. Collective. T has no pointers.
/// \throw std::length_error on rank 0 above 2 GB
template <class T>
std::vector<T> gathered(MPI_Comm comm, const std::vector<T>& own) {
  int n_ranks = 1, n = static_cast<int>(own.size() * sizeof(T));
  MPI_Comm_size(comm, &n_ranks);
  std::vector<int> counts(static_cast<std::size_t>(n_ranks), 0), begins;
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  std::size_t all = 0;
  for (const int c : counts) {
    begins.push_back(static_cast<int>(all));
    all += static_cast<std::size_t>(c);
    if (all > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw std::length_error("a list of more than 2 GB");
  }
  std::vector<T> result(all / sizeof(T));
  MPI_Gatherv(own.data(), n, MPI_BYTE, result.data(), counts.data(), begins.data(), MPI_BYTE, 0, comm);
  return result;
}

/// What rank 0 has becomes what all have. Collective. T has no pointers.
template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& list) {
  int n = static_cast<int>(list.size());
  MPI_Bcast(&n, 1, MPI_INT, 0, comm);
  list.resize(static_cast<std::size_t>(n));
  MPI_Bcast(list.data(), static_cast<int>(list.size() * sizeof(T)), MPI_BYTE, 0, comm);
}

}  // namespace umtet
