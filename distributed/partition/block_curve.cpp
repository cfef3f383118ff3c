#include "distributed/partition/block_curve.h"

#include <algorithm>
#include <bit>

namespace umtet {
namespace {

constexpr int kMostBits = 21;  // bits per coordinate, so that a position on the curve has 63 bits

}  // namespace

BlockCurve::BlockCurve(const BackgroundMesh& lattice) {
  std::int64_t most = 1;
  for (int a = 0; a < 3; ++a) {
    n_[a] = (lattice.n_cells()[a] + 1) / kCells + 1;  // the last cell with vertices follows the last cell with tets
    most = std::max(most, n_[a]);
  }
  bits_ = std::bit_width(static_cast<std::uint64_t>(most - 1));
}

std::uint64_t BlockCurve::place(const Block& block) {
  std::uint64_t place = 0;
  for (int bit = 0; bit < kMostBits; ++bit) {
    for (int a = 0; a < 3; ++a) place |= (static_cast<std::uint64_t>(block[a]) >> bit & 1) << (3 * bit + a);
  }
  return place;
}

BlockCurve::Block BlockCurve::block_at(std::uint64_t place) {
  Block block = {};
  for (int bit = 0; bit < kMostBits; ++bit) {
    for (int a = 0; a < 3; ++a) block[a] |= static_cast<std::int64_t>(place >> (3 * bit + a) & 1) << bit;
  }
  return block;
}

}  // namespace umtet
