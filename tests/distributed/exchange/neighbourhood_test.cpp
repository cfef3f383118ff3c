#include "distributed/exchange/neighbourhood.h"

#include <gtest/gtest.h>

#include "tests/distributed/ranks.h"

namespace umtet {
namespace {

using testing::n_ranks;
using testing::rank;

/// The ranks before and after this one.
std::vector<int> beside() {
  std::vector<int> list;
  for (const int r : {rank() - 1, rank() + 1}) {
    if (r >= 0 && r < n_ranks()) list.push_back(r);
  }
  return list;
}

TEST(Neighbourhood, MessagesOfAnyLengthArrive) {
  Neighbourhood ranks(MPI_COMM_WORLD, beside());
  std::vector<Neighbourhood::Bytes> out(ranks.ranks().size());
  std::size_t n_sent = 0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (int i = 0; i < 5 * rank(); ++i) put(out[k], 1000 * rank() + ranks.ranks()[k]);
    n_sent += out[k].size();
  }
  const auto in = ranks.exchange(out);
  for (std::size_t k = 0; k < in.size(); ++k) {
    const int from = ranks.ranks()[k];
    ASSERT_EQ(in[k].size(), 5 * sizeof(int) * static_cast<std::size_t>(from));
    for (std::size_t at = 0; at < in[k].size();) EXPECT_EQ(take<int>(in[k], at), 1000 * from + rank());
  }
  EXPECT_EQ(ranks.traffic().bytes, n_sent);
  EXPECT_EQ(ranks.traffic().messages, rank() == 0 ? 0U : out.size());
}

TEST(Neighbourhood, SumsAndMaximaAreThoseOfAllRanks) {
  Neighbourhood ranks(MPI_COMM_WORLD, {});
  const auto n = static_cast<std::size_t>(n_ranks());
  EXPECT_EQ(ranks.sum(std::size_t{1} << 40), n << 40);
  EXPECT_EQ(ranks.max(static_cast<std::size_t>(rank())), n - 1);
}

}  // namespace
}  // namespace umtet
