#include "mesh/core/used_vertices.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace umtet {
namespace {

// Vertices 1 and 4 are in no tet.
const std::vector<Tet> kTets = {{0, 2, 3, 5}, {6, 5, 3, 2}};

TEST(UsedVertices, AreNumberedInTheirOrder) {
  const UsedVertices used(kTets, 8);
  EXPECT_EQ(used.n(), 5);
  std::vector<int> number;
  for (int v = 0; v < 8; ++v) number.push_back(used[v]);
  EXPECT_EQ(number, (std::vector<int>{0, -1, 1, 2, -1, 3, 4, -1}));
}

TEST(UsedVertices, KeepTheirValues) {
  const UsedVertices used(kTets, 8);
  std::vector<std::string> name = {"a", "b", "c", "d", "e", "f", "g", "h"};
  used.keep(name);
  EXPECT_EQ(name, (std::vector<std::string>{"a", "c", "d", "f", "g"}));
}

TEST(UsedVertices, TetsKeepTheirVertices) {
  const UsedVertices used(kTets, 8);
  std::vector<int> vertex = {0, 1, 2, 3, 4, 5, 6, 7};
  used.keep(vertex);
  for (Tet t : kTets) {
    const Tet before = t;
    used.renumber(t);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(vertex.at(t[k]), before[k]);
  }
}

TEST(UsedVertices, NoTetUsesNoVertex) {
  const UsedVertices used({}, 3);
  EXPECT_EQ(used.n(), 0);
  std::vector<double> values = {1, 2, 3};
  used.keep(values);
  EXPECT_TRUE(values.empty());
}

}  // namespace
}  // namespace umtet
