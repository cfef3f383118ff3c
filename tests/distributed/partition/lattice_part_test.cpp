#include "distributed/partition/lattice_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace umtet {
namespace {

const BackgroundMesh& whole() {
  static const BackgroundMesh mesh(a15(), Box(Vec3::Zero(), Vec3(3, 2, 2.5)), .12);
  return mesh;
}

Partition in_five() {
  const std::uint64_t n = BlockCurve(whole()).length();
  return Partition({0, n / 5, n / 4, n / 4, n / 2, n});
}

TEST(LatticePart, EveryVertexAndCellHasOneOwner) {
  std::vector<int> n_owners(static_cast<std::size_t>(whole().n_vertices()), 0);
  std::set<std::int64_t> cells;
  for (int rank = 0; rank < 5; ++rank) {
    const LatticePart part(whole(), in_five(), rank);
    part.own().for_each([&](std::int64_t v) { ++n_owners[static_cast<std::size_t>(part.to_whole(v))]; });
    std::int64_t last = -1;
    part.for_each_own_cell([&](const BackgroundMesh::Cell&, std::int64_t cell) {
      EXPECT_GT(cell, last);
      last = cell;
      EXPECT_TRUE(cells.insert(cell).second);
    });
  }
  for (const int n : n_owners) ASSERT_EQ(n, 1);
  EXPECT_EQ(static_cast<std::int64_t>(cells.size()), whole().n_tets() / 46);
}

TEST(LatticePart, IdsAscendAsTheyDoInTheWholeAndPlacesAreTheSame) {
  for (int rank = 0; rank < 5; ++rank) {
    const LatticePart part(whole(), in_five(), rank);
    std::int64_t last = -1;
    part.known().for_each([&](std::int64_t v) {
      const std::int64_t there = part.to_whole(v);
      ASSERT_GT(there, last);
      last = there;
      ASSERT_EQ(part.from_whole(there), v);
      ASSERT_EQ(part.lattice().position(v), whole().position(there));
      ASSERT_EQ(part.owner(v) == rank, part.own().test(v));
    });
  }
}

TEST(LatticePart, EightRingsAroundAnOwnVertexAreKnown) {
  for (int rank = 0; rank < 5; ++rank) {
    const LatticePart part(whole(), in_five(), rank);
    std::set<std::int64_t> reached, front;
    part.own().for_each([&](std::int64_t v) { front.insert(part.to_whole(v)); });
    reached = front;
    std::vector<std::int64_t> link;
    for (int ring = 0; ring < 8; ++ring) {
      std::set<std::int64_t> next;
      for (const std::int64_t v : front) {
        link.clear();
        whole().link(v, link);
        for (const std::int64_t w : link) {
          if (reached.insert(w).second) next.insert(w);
        }
      }
      front = std::move(next);
    }
    for (const std::int64_t v : reached) ASSERT_GE(part.from_whole(v), 0) << rank;
  }
}

TEST(LatticePart, WhoeverKnowsAVertexIsKnownToItsOwner) {
  std::vector<LatticePart> parts;
  for (int rank = 0; rank < 5; ++rank) parts.emplace_back(whole(), in_five(), rank);
  for (int rank = 0; rank < 5; ++rank) {
    parts[rank].known().for_each([&](std::int64_t v) {
      const int owner = parts[rank].owner(v);
      if (owner == rank) return;
      const auto& knowers = parts[owner].knowers(parts[owner].from_whole(parts[rank].to_whole(v)));
      EXPECT_TRUE(std::binary_search(knowers.begin(), knowers.end(), rank));
      const auto& neighbours = parts[rank].neighbours();
      EXPECT_TRUE(std::binary_search(neighbours.begin(), neighbours.end(), owner));
    });
  }
}

TEST(LatticePart, ColoursOfBlocksAreThoseOfTheWhole) {
  const std::uint64_t n = BlockCurve(whole()).length();
  for (std::uint64_t place = 0; place + 3 < n; place += 3) {
    const LatticePart part(whole(), Partition({0, place, place + 3, n}), 1);
    for (const std::int64_t first : part.lattice().first_cell()) ASSERT_EQ(first % (2 * BlockCurve::kCells), 0);
  }
}

}  // namespace
}  // namespace umtet
