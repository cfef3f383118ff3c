#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "reconstruct/basis/lme_lattice.h"

namespace umtet {

/// Set of blocks of 8 x 8 x 8 nodes of a lattice: sparse storage for coefficients near a surface.
///
/// Block (bx, by, bz) holds the nodes 8 b - shift .. 8 b - shift + 7 of each axis, with shift = R - 1. The functions
/// that are nonzero in the cells 8 b .. 8 b + 7 then belong to the blocks b and b + 1 of each axis and to no others.
class LatticeBlocks {
 public:
  static constexpr int kEdge = 8, kNodes = kEdge * kEdge * kEdge;

  /// @param blocks  in any order, repetitions allowed; blocks outside the lattice are dropped
  LatticeBlocks(const Lattice& lattice, int half_width, std::vector<Eigen::Vector3i> blocks);

  const Lattice& lattice() const { return lattice_; }
  int size() const { return static_cast<int>(blocks_.size()); }
  /// Sorted by z, y, x.
  const std::vector<Eigen::Vector3i>& blocks() const { return blocks_; }
  /// Index of a block; -1 if it is not in the set.
  int at(const Eigen::Vector3i& block) const {
    if ((block.array() < 0).any() || (block.array() >= n_.array()).any()) return -1;
    return index_[block[0] + static_cast<std::size_t>(n_[0]) * (block[1] + static_cast<std::size_t>(n_[1]) * block[2])];
  }
  /// The first node of a block; may be negative for blocks at the wall.
  Eigen::Vector3i first_node(int index) const { return kEdge * blocks_[index] - Eigen::Vector3i::Constant(shift_); }
  int shift() const { return shift_; }
  /// Number of blocks along each axis that cover the lattice.
  const Eigen::Vector3i& n_blocks() const { return n_; }

  /// The 27 blocks around a block, itself in the middle, x fastest; -1 for blocks that are not in the set.
  std::array<int, 27> neighbours(int index) const;

  /// Copies the box of nodes first .. first + n - 1 from values stored by block (kNodes each, x fastest) to `out`, x
  /// fastest with rows of `row` values. Values are zero where there is no block. Returns false if no block meets the
  /// box.
  template <class T, class Out>
  bool copy_window(const T* values, const Eigen::Vector3i& first, const Eigen::Vector3i& n, int row, Out* out) const;

  bool operator==(const LatticeBlocks& o) const { return lattice_ == o.lattice_ && blocks_ == o.blocks_; }

 private:
  Lattice lattice_;
  int shift_;
  Eigen::Vector3i n_;
  std::vector<Eigen::Vector3i> blocks_;
  std::vector<std::int32_t> index_;
};

template <class T, class Out>
bool LatticeBlocks::copy_window(const T* values, const Eigen::Vector3i& first, const Eigen::Vector3i& n, int row,
                                Out* out) const {
  const Eigen::Vector3i begin = first + Eigen::Vector3i::Constant(shift_), end = begin + n;
  bool any = false;
  for (int bz = begin[2] >> 3; bz <= (end[2] - 1) >> 3; ++bz)
    for (int by = begin[1] >> 3; by <= (end[1] - 1) >> 3; ++by)
      for (int bx = begin[0] >> 3; bx <= (end[0] - 1) >> 3; ++bx) {
        const Eigen::Vector3i low = begin.cwiseMax(kEdge * Eigen::Vector3i(bx, by, bz)),
                              high = end.cwiseMin(kEdge * Eigen::Vector3i(bx + 1, by + 1, bz + 1));
        const int block = at({bx, by, bz}), count = high[0] - low[0];
        any = any || block >= 0;
        for (int z = low[2]; z < high[2]; ++z)
          for (int y = low[1]; y < high[1]; ++y) {
            Out* to =
                out + (low[0] - begin[0]) + row * ((y - begin[1]) + static_cast<std::ptrdiff_t>(n[1]) * (z - begin[2]));
            if (block < 0) {
              std::fill(to, to + count, Out(0));
            } else {
              const T* from = values + static_cast<std::size_t>(block) * kNodes + ((z & 7) * kEdge + (y & 7)) * kEdge +
                              (low[0] & 7);
              std::copy(from, from + count, to);
            }
          }
      }
  return any;
}

}  // namespace umtet
