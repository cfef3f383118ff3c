#include "distributed/exchange/id_order.h"

#include "distributed/exchange/selection.h"

namespace umtet {

IdOrder::IdOrder(MPI_Comm comm, const std::vector<std::int64_t>& ids, std::size_t piece)
    : comm_(comm), ids_(ids), piece_(piece) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  rank_ = static_cast<std::size_t>(rank);
  n_ranks_ = static_cast<std::size_t>(n_ranks);
  std::uint64_t n = ids.size();
  MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPI_UINT64_T, MPI_SUM, comm);
  n_ = n;
  const std::size_t n_rounds = (n_ + piece * n_ranks_ - 1) / (piece * n_ranks_);
  std::vector<std::uint64_t> before;
  for (std::size_t p = 0; p <= n_rounds * n_ranks_; ++p) before.push_back(std::min(n_, p * piece));
  for (const std::int64_t bound : bounds_of(comm, ids, before))
    begin_.push_back(static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), bound) - ids.begin()));
}

std::vector<std::int64_t> IdOrder::sums_before(const std::vector<std::int64_t>& values) const {
  struct Valued {
    std::int64_t id, value;
  };
  struct Named {
    Valued of;
    std::size_t from, place;  ///< a rank, and a position in its message
  };
  std::vector<std::int64_t> sums;
  sums.reserve(ids_.size());
  std::int64_t of_rounds = 0;
  for (std::size_t round = 0; round < n_rounds(); ++round) {
    std::vector<std::vector<Valued>> out(n_ranks_);
    std::vector<std::vector<std::int64_t>> answers(n_ranks_);
    for (std::size_t r = 0; r < n_ranks_; ++r) {
      const std::size_t p = round * n_ranks_ + r;
      for (std::size_t k = begin_[p]; k < begin_[p + 1]; ++k) out[r].push_back({ids_[k], values[k]});
    }
    std::vector<Named> all;
    const auto in = all_to_all(comm_, out);
    std::int64_t own = 0, before = 0;
    for (std::size_t r = 0; r < n_ranks_; ++r) {
      answers[r].resize(in[r].size());
      for (std::size_t k = 0; k < in[r].size(); ++k) {
        all.push_back({in[r][k], r, k});
        own += in[r][k].value;
      }
    }
    std::sort(all.begin(), all.end(), [](const Named& a, const Named& b) { return a.of.id < b.of.id; });
    MPI_Exscan(&own, &before, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (rank_ == 0) before = 0;  // not set by MPI
    std::int64_t sum = of_rounds + before;
    for (const Named& named : all) {
      answers[named.from][named.place] = sum;
      sum += named.of.value;
    }
    for (const auto& some : all_to_all(comm_, answers)) sums.insert(sums.end(), some.begin(), some.end());
    MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_INT64_T, MPI_SUM, comm_);
    of_rounds += own;
  }
  return sums;
}

}  // namespace umtet
