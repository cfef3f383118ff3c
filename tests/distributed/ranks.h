#pragma once

#include <mpi.h>

#include <vector>

namespace umtet::testing {

inline int rank() {
  int r = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &r);
  return r;
}

inline int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

/// What all ranks have, one behind the other; on rank 0, and nothing elsewhere. T has no pointers.
template <class T>
std::vector<T> gathered(const std::vector<T>& own) {
  int n = static_cast<int>(own.size() * sizeof(T)), all = 0;
  std::vector<int> counts(static_cast<std::size_t>(n_ranks())), begins;
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, MPI_COMM_WORLD);
  for (const int c : counts) {
    begins.push_back(all);
    all += c;
  }
  std::vector<T> result(rank() == 0 ? static_cast<std::size_t>(all) / sizeof(T) : 0);
  MPI_Gatherv(own.data(), n, MPI_BYTE, result.data(), counts.data(), begins.data(), MPI_BYTE, 0, MPI_COMM_WORLD);
  return result;
}

}  // namespace umtet::testing
