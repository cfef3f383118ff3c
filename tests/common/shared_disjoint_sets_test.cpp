#include "common/shared_disjoint_sets.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "common/disjoint_sets.h"
#include "common/first_touch.h"

namespace umtet {
namespace {

// Pairs of all lengths, so that threads meet at the same roots.
TEST(SharedDisjointSets, AreThoseOfOneThread) {
  constexpr std::uint32_t kMembers = 100'000, kPairs = 80'000;
  std::mt19937 random(5);
  std::vector<std::uint32_t> a(kPairs), b(kPairs);
  for (std::uint32_t k = 0; k < kPairs; ++k) a[k] = random() % kMembers, b[k] = random() % kMembers;
  DisjointSets one(kMembers);
  for (std::uint32_t k = 0; k < kPairs; ++k) one.unite(static_cast<int>(a[k]), static_cast<int>(b[k]));
  SharedDisjointSets shared(kMembers);
  tbb::parallel_for(std::uint32_t{0}, kPairs, [&](std::uint32_t k) { shared.unite(a[k], b[k]); });
  for (std::uint32_t i = 0; i < kMembers; ++i)
    ASSERT_EQ(shared.find(i), static_cast<std::uint32_t>(one.find(static_cast<int>(i))));
}

TEST(FirstTouch, GivesRoomAndZeros) {
  for (const std::size_t n :
       {std::size_t{0}, std::size_t{1}, std::size_t{511}, std::size_t{512}, std::size_t{1'000'000}}) {
    const std::vector<double> room = reserved<double>(n);
    EXPECT_TRUE(room.empty());
    EXPECT_GE(room.capacity(), n);
    EXPECT_EQ(touched<double>(n), std::vector<double>(n, 0.));
    const std::vector<double> ones(n, 1.);
    EXPECT_EQ(copied(std::span<const double>(ones)), ones);
  }
}

}  // namespace
}  // namespace umtet
