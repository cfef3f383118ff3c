#include "distributed/partition/partition.h"

#include <gtest/gtest.h>

#include "distributed/partition/first_share.h"
#include "tests/distributed/ranks.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

TEST(Partition, EveryBlockHasOneOwnerAndAllRanksKnowTheSame) {
  const auto domain = testing::torus();
  const BackgroundMesh lattice(a15(), domain.box, .05);
  const Partition partition = balanced_partition(MPI_COMM_WORLD, lattice, domain);
  const BlockCurve curve(lattice);
  ASSERT_EQ(partition.n_ranks(), testing::n_ranks());
  EXPECT_EQ(partition.begin(0), 0U);
  EXPECT_EQ(partition.end(partition.n_ranks() - 1), curve.length());
  std::uint64_t sum = 0;
  for (std::uint64_t place = 0; place < curve.length(); ++place) {
    const int owner = partition.owner(BlockCurve::block_at(place));
    EXPECT_TRUE(partition.begin(owner) <= place && place < partition.end(owner));
    sum = 31 * sum + static_cast<std::uint64_t>(owner);
  }
  for (const std::uint64_t other : testing::gathered(std::vector<std::uint64_t>{sum})) EXPECT_EQ(other, sum);
}

TEST(Partition, APieceWithTheBoundaryIsShorter) {
  // All of the boundary is near the beginning of the curve.
  auto domain = testing::sphere();
  domain.box = Box(Vec3::Constant(-1.2), Vec3::Constant(6));
  const BackgroundMesh lattice(a15(), domain.box, .1);
  const Partition partition = balanced_partition(MPI_COMM_WORLD, lattice, domain);
  if (testing::n_ranks() == 1) return;
  const auto n = static_cast<std::uint64_t>(testing::n_ranks());
  EXPECT_LT(partition.end(0) - partition.begin(0), BlockCurve(lattice).length() / n / 2);
}

TEST(FirstShare, LetsAllRanksHoldTheSameUntilTheOthersWouldWaitForEachOther) {
  for (const int n : {2, 4, 64}) {
    EXPECT_DOUBLE_EQ(first_share(n, 0, 1e9), 1. / n);
    const double share = first_share(n, .5e9 / n, 1e9);
    EXPECT_NEAR(.5e9 / n + share * 1e9, (1 - share) / (n - 1) * 1e9, 1) << n;
    EXPECT_DOUBLE_EQ(first_share(n, 1e12, 1e9), .25 / n);
    for (int rank = 1; rank < n; ++rank)
      EXPECT_NEAR(share_before(rank + 1, n, share) - share_before(rank, n, share), (1 - share) / (n - 1), 1e-12);
    EXPECT_EQ(share_before(0, n, share), 0);
    EXPECT_EQ(share_before(1, n, share), share);
    EXPECT_EQ(share_before(n, n, share), 1);
  }
  EXPECT_EQ(first_share(1, 1e9, 1e9), 1);
  EXPECT_EQ(share_before(1, 1, 1), 1);
}

TEST(Partition, WhatRank0HoldsBesidesMakesItsPieceShorter) {
  const auto domain = testing::torus();
  const BackgroundMesh lattice(a15(), domain.box, .05);
  const auto length = [&](const Partition& p, int rank) { return static_cast<double>(p.end(rank) - p.begin(rank)); };
  // Only what rank 0 says counts.
  const Partition equal = balanced_partition(MPI_COMM_WORLD, lattice, domain, testing::rank() == 0 ? 0 : 1e12),
                  less = balanced_partition(MPI_COMM_WORLD, lattice, domain, testing::rank() == 0 ? 1e12 : 0);
  if (testing::n_ranks() == 1) return;
  EXPECT_LT(length(less, 0), .6 * length(equal, 0));
  EXPECT_EQ(less.end(testing::n_ranks() - 1), equal.end(testing::n_ranks() - 1));
}

TEST(Partition, ABlockHasTheOwnerOfAPieceThatIsNotEmpty) {
  const Partition partition({0, 2, 2, 8});
  EXPECT_EQ(partition.owner(BlockCurve::block_at(1)), 0);
  EXPECT_EQ(partition.owner(BlockCurve::block_at(2)), 2);
  EXPECT_EQ(partition.owner(BlockCurve::block_at(7)), 2);
}

}  // namespace
}  // namespace umtet
