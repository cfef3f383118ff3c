#include "pipeline/output/detail/worst_tets.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "common/indices_where.h"

namespace umtet::detail {
namespace {

// More tets than a task has, in steps of .001: many are equal, and their numbers decide.
TEST(WorstTets, AreThoseThatOneThreadFinds) {
  std::mt19937 random(4);
  std::vector<double> quality(200'000);
  for (double& q : quality) q = static_cast<double>(random() % 1000) / 1000;
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{500}, std::size_t{70'000}, quality.size()}) {
    std::vector<int> all = worst_first(quality, n);
    all.resize(n);
    EXPECT_EQ(worst_of(quality, n), all);
    for (std::size_t k = 1; k < n; ++k) ASSERT_LE(quality[all[k - 1]], quality[all[k]]);
  }
}

TEST(IndicesWhere, AscendAndMissNone) {
  const std::vector<int> found = indices_where<int>(100'000, [](std::size_t i) { return i % 3 == 0; });
  ASSERT_EQ(found.size(), 33'334U);
  for (std::size_t k = 0; k < found.size(); ++k) ASSERT_EQ(found[k], static_cast<int>(3 * k));
  EXPECT_TRUE(indices_where<int>(0, [](std::size_t) { return true; }).empty());
}

}  // namespace
}  // namespace umtet::detail
