#include "reconstruct/basis/lattice_blocks.h"

#include <algorithm>

namespace umtet {

LatticeBlocks::LatticeBlocks(const Lattice& lattice, int half_width, std::vector<Eigen::Vector3i> blocks)
    : lattice_(lattice), shift_(half_width - 1), blocks_(std::move(blocks)) {
  n_ = (lattice.n.array() + shift_ + kEdge - 1) / kEdge;
  std::erase_if(blocks_,
                [&](const Eigen::Vector3i& b) { return (b.array() < 0).any() || (b.array() >= n_.array()).any(); });
  const auto key = [](const Eigen::Vector3i& b) { return std::array{b[2], b[1], b[0]}; };
  std::sort(blocks_.begin(), blocks_.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
  index_.assign(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2], -1);
  for (int b = 0; b < size(); ++b) {
    const Eigen::Vector3i& at = blocks_[b];
    index_[at[0] + static_cast<std::size_t>(n_[0]) * (at[1] + static_cast<std::size_t>(n_[1]) * at[2])] = b;
  }
}

std::array<int, 27> LatticeBlocks::neighbours(int index) const {
  std::array<int, 27> near;
  int at_near = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) near[at_near++] = at(blocks_[index] + Eigen::Vector3i(x, y, z));
  return near;
}

}  // namespace umtet
