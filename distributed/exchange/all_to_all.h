#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "distributed/exchange/mpi_count.h"

namespace umtet {

/// Exchanges lists between all ranks (MPI_Alltoallv): sends out[r] to rank r, and returns the list from each rank.
/// Collective. T must not contain pointers.
/// \throw std::length_error above 2^31 - 1 members
template <class T>
std::vector<std::vector<T>> all_to_all(MPI_Comm comm, const std::vector<std::vector<T>>& out) {
  struct Layout {
    std::vector<int> count, begin;
    std::vector<T> all;
  } sent, received;
  const auto lay_out = [](Layout& layout) {
    std::size_t n = 0;
    for (const int c : layout.count) {
      layout.begin.push_back(static_cast<int>(n));
      n += static_cast<std::size_t>(c);
      mpi_count(n);
    }
    layout.all.reserve(n);
    return n;
  };
  for (const auto& list : out) sent.count.push_back(mpi_count(list.size()));
  lay_out(sent);
  for (const auto& list : out) sent.all.insert(sent.all.end(), list.begin(), list.end());
  received.count.resize(out.size());
  MPI_Alltoall(sent.count.data(), 1, MPI_INT, received.count.data(), 1, MPI_INT, comm);
  received.all.resize(lay_out(received));
  MPI_Datatype type;
  MPI_Type_contiguous(static_cast<int>(sizeof(T)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Alltoallv(sent.all.data(), sent.count.data(), sent.begin.data(), type, received.all.data(), received.count.data(),
                received.begin.data(), type, comm);
  MPI_Type_free(&type);
  std::vector<std::vector<T>> in;
  for (std::size_t r = 0; r < out.size(); ++r) {
    const auto first = received.all.begin() + received.begin[r];
    in.emplace_back(first, first + received.count[r]);
  }
  return in;
}

}  // namespace umtet
