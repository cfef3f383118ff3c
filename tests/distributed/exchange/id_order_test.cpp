#include "distributed/exchange/id_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "distributed/exchange/piece_chain.h"
#include "distributed/exchange/selection.h"
#include "tests/distributed/ranks.h"

namespace umtet {
namespace {

using testing::n_ranks;
using testing::rank;

/// Own ones of n ids, 7 apart, that are dealt to ranks without order.
std::vector<std::int64_t> dealt(std::int64_t n) {
  std::vector<std::int64_t> ids;
  for (std::int64_t k = 0; k < n; ++k) {
    if (static_cast<std::int64_t>((static_cast<std::uint64_t>(k) * 0x9e3779b97f4a7c15u >> 33) % 1000) % n_ranks() ==
        rank())
      ids.push_back(7 * k);
  }
  return ids;
}

struct Row {
  std::int64_t id;
  double value;
};

TEST(IdOrder, PiecesAreConsecutiveAndOfTheSameLength) {
  for (const std::int64_t n : {0, 1, 5, 100, 1001}) {
    const std::vector<std::int64_t> ids = dealt(n);
    const IdOrder order(MPI_COMM_WORLD, ids, 10);
    EXPECT_EQ(order.n(), static_cast<std::size_t>(n));
    for (std::size_t round = 0; round < order.n_rounds(); ++round) {
      const std::vector<Row> piece = order.piece<Row>(round, [&](std::size_t k) {
        return Row{ids[k], .5 * static_cast<double>(ids[k])};
      });
      ASSERT_EQ(piece.size(), order.size(round));
      for (std::size_t k = 0; k < piece.size(); ++k) {
        EXPECT_EQ(piece[k].id, 7 * static_cast<std::int64_t>(order.first(round) + k));
        EXPECT_EQ(piece[k].value, .5 * static_cast<double>(piece[k].id));
      }
    }
  }
}

TEST(IdOrder, NumbersCountWhatIsLess) {
  const std::vector<std::int64_t> ids = dealt(777);
  const std::vector<std::int64_t> numbers = IdOrder(MPI_COMM_WORLD, ids, 16).numbers();
  ASSERT_EQ(numbers.size(), ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k) EXPECT_EQ(numbers[k], ids[k] / 7);
}

TEST(IdOrder, SumsAreThoseOfWhatIsLess) {
  const std::vector<std::int64_t> ids = dealt(777);
  std::vector<std::int64_t> values;
  for (const std::int64_t id : ids) values.push_back(id / 7 % 5);
  const std::vector<std::int64_t> sums = IdOrder(MPI_COMM_WORLD, ids, 16).sums_before(values);
  std::vector<std::int64_t> expected = {0};
  for (std::int64_t k = 0; k < 777; ++k) expected.push_back(expected.back() + k % 5);
  ASSERT_EQ(sums.size(), ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k) EXPECT_EQ(sums[k], expected[static_cast<std::size_t>(ids[k] / 7)]);
}

TEST(PieceChain, AddsInTheOrderOfPieces) {
  // Sums of these depend on their order.
  const auto term = [](std::int64_t id) { return 1. / static_cast<double>(id % 91 + 1) * (id % 3 == 0 ? 1e9 : 1.); };
  const std::vector<std::int64_t> ids = dealt(1000);
  const IdOrder order(MPI_COMM_WORLD, ids, 10);
  PieceChain chain(MPI_COMM_WORLD, 1);
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const auto piece = order.piece<Row>(round, [&](std::size_t k) { return Row{ids[k], term(ids[k])}; });
    chain.pass([&](std::vector<double>& sum) {
      for (const Row& row : piece) sum[0] += row.value;
    });
  }
  double all = 0;
  for (std::int64_t k = 0; k < 1000; ++k) all += term(7 * k);
  EXPECT_EQ(chain.end()[0], all);
}

TEST(Selection, FindsTheValuesThatSortingFinds) {
  std::vector<double> all, own;
  for (int k = 0; k < 500; ++k) all.push_back(k == 7 ? -1 : (k * 37 % 101) * .01 - .2);
  for (std::size_t k = static_cast<std::size_t>(rank()); k < all.size(); k += static_cast<std::size_t>(n_ranks()))
    own.push_back(all[k]);
  std::sort(all.begin(), all.end());
  std::sort(own.begin(), own.end());
  const std::vector<std::uint64_t> places = {0, 1, 17, 250, 499};
  const std::vector<double> found = values_at(MPI_COMM_WORLD, own, places);
  for (std::size_t k = 0; k < places.size(); ++k) EXPECT_EQ(found[k], all[places[k]]);
}

TEST(Selection, BoundsMayBeAsFarApartAsNumbersAllow) {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min() + 1;
  const std::vector<std::int64_t> own =
      rank() == 0 ? std::vector<std::int64_t>{kLeast, 3} : std::vector<std::int64_t>{};
  const std::vector<std::int64_t> bounds = bounds_of(MPI_COMM_WORLD, own, {0, 1, 2});
  EXPECT_EQ(bounds[0], kLeast);
  EXPECT_EQ(bounds[1], kLeast + 1);
  EXPECT_EQ(bounds[2], 4);
}

}  // namespace
}  // namespace umtet
