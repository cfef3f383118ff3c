#include "mesh/base/id_list.h"

#include <gtest/gtest.h>

#include <map>

using umtet::IdList;

// Ids of a lattice, many of one row and some of all others, as patches have them: more than its first table holds.
TEST(IdList, NumbersEveryIdOnceInTheOrderOfComing) {
  IdList list;
  std::map<std::int64_t, int> reference;
  EXPECT_EQ(list.find(7), -1);
  for (int k = 0; k < 6000; ++k) {
    const std::int64_t id = (k % 7) * 1000003LL * 8 + (k * k) % 5003 - 40;
    const auto [at, is_new] = reference.emplace(id, static_cast<int>(reference.size()));
    ASSERT_EQ(list.test(id), !is_new);
    ASSERT_EQ(list.add(id), at->second);
  }
  ASSERT_EQ(list.ids().size(), reference.size());
  ASSERT_GT(reference.size(), 2000u);
  for (const auto& [id, number] : reference) {
    ASSERT_EQ(list.find(id), number);
    ASSERT_EQ(list.ids()[static_cast<std::size_t>(number)], id);
    ASSERT_EQ(list.test_any(id + (std::int64_t{1} << 40)), false);
  }
}
