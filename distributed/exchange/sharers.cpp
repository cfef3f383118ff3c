#include "distributed/exchange/sharers.h"

#include <algorithm>

#include "distributed/exchange/collect.h"

namespace umtet {

Sharers sharers_of(MPI_Comm comm, const OwnerExchange& items) {
  const int own_rank = rank_in(comm);
  std::vector<std::vector<int>> users(items.n_owned());  // ascending, because messages are read in the order of ranks
  items.ask([&](std::size_t) { return own_rank; }, [&](std::size_t k, int rank) { users[k].push_back(rank); });
  std::size_t most = 0;
  for (const auto& list : users) most = std::max(most, list.size());
  std::uint64_t most_of_all = most;
  MPI_Allreduce(MPI_IN_PLACE, &most_of_all, 1, MPI_UINT64_T, MPI_MAX, comm);
  std::vector<std::vector<int>> known(items.n_items());
  for (std::size_t j = 0; j < most_of_all; ++j) {
    std::vector<int> jth;
    jth.reserve(users.size());
    for (const auto& list : users) jth.push_back(j < list.size() ? list[j] : -1);
    const std::vector<int> told = items.tell(jth);
    for (std::size_t v = 0; v < known.size(); ++v)
      if (told[v] >= 0 && told[v] != own_rank) known[v].push_back(told[v]);
  }
  Sharers sharers;
  for (std::size_t v = 0; v < known.size(); ++v) {
    if (known[v].empty()) continue;
    sharers.vertex.push_back(static_cast<int>(v));
    sharers.begin.push_back(sharers.rank.size());
    sharers.rank.insert(sharers.rank.end(), known[v].begin(), known[v].end());
  }
  sharers.begin.push_back(sharers.rank.size());
  return sharers;
}

std::vector<int> first_ranks(MPI_Comm comm, std::size_t n_items, const Sharers& sharers) {
  std::vector<int> first(n_items, rank_in(comm));
  for (std::size_t k = 0; k < sharers.vertex.size(); ++k) {
    int& least = first[static_cast<std::size_t>(sharers.vertex[k])];
    least = std::min(least, sharers.rank[sharers.begin[k]]);
  }
  return first;
}

std::vector<std::int64_t> numbers_by_rank(MPI_Comm comm, const std::vector<int>& first_rank,
                                          const OwnerExchange& items) {
  const int own_rank = rank_in(comm);
  std::int64_t n = std::count(first_rank.begin(), first_rank.end(), own_rank), before = 0;
  MPI_Exscan(&n, &before, 1, MPI_INT64_T, MPI_SUM, comm);
  if (own_rank == 0) before = 0;  // not defined by MPI
  std::vector<std::int64_t> number(first_rank.size(), -1), of_owned(items.n_owned(), -1);
  for (std::size_t v = 0; v < number.size(); ++v)
    if (first_rank[v] == own_rank) number[v] = before++;
  items.ask([&](std::size_t v) { return number[v]; },
            [&](std::size_t k, std::int64_t x) { of_owned[k] = std::max(of_owned[k], x); });
  return items.tell(of_owned);
}

}  // namespace umtet
