#include "distributed/partition/block_curve.h"

#include <gtest/gtest.h>

#include <set>

namespace umtet {
namespace {

TEST(BlockCurve, PlacesAndBlocksAreOneToOne) {
  const BackgroundMesh lattice(a15(), Box(Vec3::Zero(), Vec3(3, 2, 1)), .1);
  const BlockCurve curve(lattice);
  std::int64_t n = 0;
  for (std::uint64_t place = 0; place < curve.length(); ++place) {
    const BlockCurve::Block block = BlockCurve::block_at(place);
    EXPECT_EQ(BlockCurve::place(block), place);
    n += curve.holds(block);
  }
  EXPECT_EQ(n, curve.n()[0] * curve.n()[1] * curve.n()[2]);
}

TEST(BlockCurve, HasABlockForEveryVertex) {
  const BackgroundMesh lattice(a15(), Box(Vec3::Zero(), Vec3(3, 2, 1)), .3);
  const BlockCurve curve(lattice);
  std::set<std::uint64_t> met;
  for (std::int64_t v = 0; v < lattice.n_vertices(); ++v) {
    const BlockCurve::Block block = BlockCurve::block_of(lattice.cell(v));
    ASSERT_TRUE(curve.holds(block));
    met.insert(BlockCurve::place(block));
  }
  EXPECT_EQ(static_cast<std::int64_t>(met.size()), curve.n()[0] * curve.n()[1] * curve.n()[2]);
}

TEST(BlockCurve, PlacesAreNumbersOf64Bits) {
  const std::int64_t far = (std::int64_t{1} << 21) - 1;  // a cube of so many blocks has 10^22 tets
  EXPECT_EQ(BlockCurve::block_at(BlockCurve::place({far, 0, far - 1})), (BlockCurve::Block{far, 0, far - 1}));
  EXPECT_LT(BlockCurve::place({far, far, far}), std::uint64_t{1} << 63);
}

}  // namespace
}  // namespace umtet
