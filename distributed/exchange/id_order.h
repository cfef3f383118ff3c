#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/all_to_all.h"

namespace umtet {

/// Redistribution of distributed items in the order of their ids. In each round, every rank receives a piece of
/// consecutive items, rank 0 the first piece. Operations that depend on the order, such as sums of doubles and files,
/// work on these pieces. No rank holds more than a piece.
class IdOrder {
 public:
  /// Collective.
  /// @param ids    local ids, ascending, each id on one rank; must outlive the object
  /// @param piece  number of items in a piece; the last pieces have fewer
  IdOrder(MPI_Comm comm, const std::vector<std::int64_t>& ids, std::size_t piece);

  std::size_t n() const { return n_; }  ///< number of items on all ranks
  std::size_t n_rounds() const { return (begin_.size() - 1) / n_ranks_; }
  /// Number of items before this rank's piece, and number of items in it.
  std::size_t first(std::size_t round) const { return std::min(n_, piece_ * (round * n_ranks_ + rank_)); }
  std::size_t size(std::size_t round) const {
    return std::min(n_, piece_ * (round * n_ranks_ + rank_ + 1)) - first(round);
  }
  /// Indices into `ids` of the local items sent in a round: from begin(round) to begin(round + 1).
  std::size_t begin(std::size_t round) const { return begin_[round * n_ranks_]; }

  /// Returns the piece of this rank, in ascending order of ids. Collective.
  /// @param row  row(k) is the data sent for ids[k], a T without pointers, with a member `id`
  template <class T, class Row>
  std::vector<T> piece(std::size_t round, const Row& row) const {
    std::vector<std::vector<T>> out(n_ranks_);
    for (std::size_t r = 0; r < n_ranks_; ++r) {
      const std::size_t p = round * n_ranks_ + r;
      out[r].reserve(begin_[p + 1] - begin_[p]);
      for (std::size_t k = begin_[p]; k < begin_[p + 1]; ++k) out[r].push_back(row(k));
    }
    std::vector<T> all;
    all.reserve(size(round));
    for (const std::vector<T>& some : all_to_all(comm_, out)) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end(), [](const T& a, const T& b) { return a.id < b.id; });
    return all;
  }
  /// Returns for each local id the number of smaller ids on all ranks. Collective.
  std::vector<std::int64_t> numbers() const { return sums_before(std::vector<std::int64_t>(ids_.size(), 1)); }
  /// Returns for each local id the sum of the values of all smaller ids. Collective.
  /// @param values  values of the local ids
  std::vector<std::int64_t> sums_before(const std::vector<std::int64_t>& values) const;

 private:
  MPI_Comm comm_;
  const std::vector<std::int64_t>& ids_;
  std::size_t piece_, n_ = 0, n_ranks_ = 1, rank_ = 0;
  std::vector<std::size_t> begin_;  ///< begin of each piece in the local ids, and the end
};

}  // namespace umtet
