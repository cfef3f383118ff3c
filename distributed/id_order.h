#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/all_to_all.h"

namespace umtet {

/// What has ids and is spread over ranks, in the order of ids: round after round each rank is sent a piece of
/// consecutive ones, rank 0 the first of a round. What depends on order is done with pieces: sums of doubles, files.
/// Nobody holds more than a piece.
class IdOrder {
 public:
  /// Collective.
  /// @param ids    own ones, ascending, each id on one rank; stays where it is
  /// @param piece  members of a piece; the last ones have fewer
  IdOrder(MPI_Comm comm, const std::vector<std::int64_t>& ids, std::size_t piece);

  std::size_t n() const { return n_; }  ///< of all ranks
  std::size_t n_rounds() const { return (begin_.size() - 1) / n_ranks_; }
  /// How many are before this rank's piece, and how many are in it.
  std::size_t first(std::size_t round) const { return std::min(n_, piece_ * (round * n_ranks_ + rank_)); }
  std::size_t size(std::size_t round) const {
    return std::min(n_, piece_ * (round * n_ranks_ + rank_ + 1)) - first(round);
  }
  /// Places in `ids` of the own ones that are sent in a round: from begin(round) to begin(round + 1).
  std::size_t begin(std::size_t round) const { return begin_[round * n_ranks_]; }

  /// The piece, ascending. Collective.
  /// @param row  row(k) is what is sent of ids[k], a T without pointers, with a member `id`
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
  /// How many ids of all ranks are less than each of the own ones. Collective.
  std::vector<std::int64_t> numbers() const { return sums_before(std::vector<std::int64_t>(ids_.size(), 1)); }
  /// Of all ids that are less than each of the own ones the sum of their values. Collective. @param values  of own ones
  std::vector<std::int64_t> sums_before(const std::vector<std::int64_t>& values) const;

 private:
  MPI_Comm comm_;
  const std::vector<std::int64_t>& ids_;
  std::size_t piece_, n_ = 0, n_ranks_ = 1, rank_ = 0;
  std::vector<std::size_t> begin_;  ///< of each piece, and at last the end, among the own ones
};

}  // namespace umtet
