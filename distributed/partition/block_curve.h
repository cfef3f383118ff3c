#pragma once

#include <array>
#include <cstdint>

#include "mesh/background/background_mesh.h"

namespace umtet {

/// Morton curve of blocks of 4^3 cells of a lattice, the blocks of classify_vertices(). Vertices of cell c, which
/// counts from -1, are in block (c + 1) / 4.
class BlockCurve {
 public:
  using Block = std::array<std::int64_t, 3>;
  static constexpr std::int64_t kCells = 4;

  explicit BlockCurve(const BackgroundMesh& lattice);

  const Block& n() const { return n_; }
  bool holds(const Block& b) const {
    return b[0] >= 0 && b[1] >= 0 && b[2] >= 0 && b[0] < n_[0] && b[1] < n_[1] && b[2] < n_[2];
  }
  static Block block_of(const BackgroundMesh::Cell& cell) {
    return {(cell[0] + 1) / kCells, (cell[1] + 1) / kCells, (cell[2] + 1) / kCells};
  }
  /// Positions on the curve are 0 .. length() - 1; not every position has a block.
  std::uint64_t length() const { return std::uint64_t{1} << 3 * bits_; }
  static std::uint64_t place(const Block& block);
  static Block block_at(std::uint64_t place);

 private:
  Block n_;
  int bits_;
};

}  // namespace umtet
